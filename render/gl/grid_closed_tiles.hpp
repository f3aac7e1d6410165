// SPDX-License-Identifier: BSD-3-Clause
//
// Where a picture that is drawn from front to back needs nothing more: WVG91 §4 stops there. A pixel is closed when what is left to be drawn
// does not reach it, or when it is opaque. Its fragments are dropped before they are shaded, by the depth test; cells and slabs whose
// tiles are all closed need not be drawn at all.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "render/gl/grid_view.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/programs.hpp"
#include "render/gl/triangle_stream.hpp"

namespace cellproj::gl {

// A corner of an outline, in clip space.
struct OutlineVertex {
    float x, y;
};
std::span<const VertexAttribute> vertex_attributes(const OutlineVertex*);

class ClosedTiles {
public:
    static constexpr int side = 8;  // pixels

    // All must outlive this, in which time blending is that of front to back and depths are not written. `picture`: bound, with
    // depths, cleared. `opaque`: the opacity above which a pixel is.
    ClosedTiles(const GridView& view, const Target& picture, Programs& programs, TriangleStream& outlines, float opaque);
    ~ClosedTiles();
    ClosedTiles(const ClosedTiles&) = delete;
    ClosedTiles& operator=(const ClosedTiles&) = delete;

    // Waits for what has been drawn. All that is still to be drawn lies in the convex hull of `rest`, places about the view's reference point.
    // Changes the current program. Returns whether a tile has closed since the last time.
    bool look(std::span<const glm::dvec3> rest);

    bool all() const { return open_ == 0; }
    // Whether what lies in the convex hull of these places, about the reference point, covers closed tiles alone, or nothing of the picture.
    bool hide(std::span<const glm::dvec3> corners) const;

private:
    void sum_up(std::span<const std::size_t> open);

    const GridView& view_;
    const Target& picture_;
    const Program& program_;
    TriangleStream& outlines_;
    std::size_t columns_, rows_;       // of tiles
    std::size_t open_;                 // how many are
    std::vector<std::size_t> before_;  // (rows + 1) × (columns + 1): open tiles above and to the left
};

// How many steps of a drawing go by between two looks at what has closed. A look waits for the driver, and reads a depth for each pixel.
class LookRhythm {
public:
    // `steps`: of the drawing. Looks come 32 times, unless nothing closes: then ever less often, about 10 times.
    explicit LookRhythm(std::size_t steps) : least_((steps + 31) / 32), most_((steps + 7) / 8), step_(least_) {}

    std::size_t step() const { return step_; }
    void looked(bool closed) { step_ = closed ? least_ : step_ + least_ < most_ ? step_ + least_ : most_; }

private:
    std::size_t least_, most_, step_;
};

}  // namespace cellproj::gl
