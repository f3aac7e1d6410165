// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces by classification: which of them a segment of a viewing ray crosses, told from its two scalars alone (RKE00 §5–7).
// No triangle is ever extracted, and what lies between two isovalues costs nothing.
//
// One rule decides everything: a scalar is *below* an isovalue v when s < v, at or above it otherwise; a segment crosses the
// surface when one end is below and the other is not. So
// - segments that follow each other on a ray with the same scalar between them cross a surface exactly as often as the ray
//   changes sides: once where it passes, also where v is the scalar in between; twice (through and back, at one place) or never
//   where it touches v and turns back. Nothing is doubled or lost on shared faces, edges and vertices, and no seam is left;
// - a cell that is wholly at v crosses nothing itself: it belongs to the side above. Its border to what is below is the surface.
//
// The front side of a surface is that of the lower scalars, as the normals of contour filters point: a ray sees it where
// the scalar rises.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "classify/transfer_function.hpp"

namespace cellproj {

struct IsoSurface {
    double value = 0;                        // any finite scalar
    glm::dvec3 color{1.0};                   // of the material, ≥ 0, not associated
    double opacity = 1;                      // 0..1
    std::optional<glm::dvec3> back_color{};  // of its back side; nothing: as in front
};

struct IsoCrossing {
    std::size_t surface;  // index into IsoSurfaces::surfaces()
    double t;             // 0..1, share of the way from the segment's front to its back
    bool rising;          // the scalar rises along the ray: the front side is seen
};

// The surfaces that one segment crosses, from its front to its back. Nothing is stored: they are counted off the list.
class IsoCrossings {
public:
    IsoCrossings(std::span<const IsoSurface> surfaces, std::size_t first, std::size_t last, double s_f, double s_b)
        : surfaces_(surfaces), first_(first), last_(last), s_f_(s_f), s_b_(s_b) {}

    std::size_t size() const { return last_ - first_; }
    bool empty() const { return first_ == last_; }
    // i < size(); t never falls as i grows.
    IsoCrossing operator[](std::size_t i) const;

private:
    std::span<const IsoSurface> surfaces_;  // ascending
    std::size_t first_, last_;              // those between s_f and s_b
    double s_f_, s_b_;
};

// A set of isosurfaces. Immutable. Crossings point into it: they live no longer than it does.
class IsoSurfaces {
public:
    // In any order. Throws Error (option), naming `place` and the surface (counted from 0), when a value or colour is not
    // finite, a colour negative, an opacity outside of 0..1, or a value given twice.
    explicit IsoSurfaces(std::vector<IsoSurface> surfaces, const std::string& place = "isosurfaces");

    const std::vector<IsoSurface>& surfaces() const { return surfaces_; }  // by ascending value
    bool opaque() const;                                                   // every one of them has opacity 1

    // Finite scalars. Two binary searches, then the surfaces crossed: O(log N + crossed).
    IsoCrossings crossings(double s_f, double s_b) const;

private:
    std::vector<IsoSurface> surfaces_;
};

// The side of a surface that is seen.
inline const glm::dvec3& seen_color(const IsoSurface& surface, bool rising) {
    return rising || !surface.back_color ? surface.color : *surface.back_color;
}

// A layer of that colour in front of nothing: associated.
inline Light layer(const glm::dvec3& color, double opacity) { return {opacity * color, opacity}; }

// The fast form: one lookup in a table over (s_f, s_b) (RKE00 Fig. 6, 9 and 13) instead of the search, for segments without light
// of their own. n × n texels over low..high, read at the nearest one.
//
// Error: both scalars are rounded to the table's grid of step h = (high − low)/(n − 1), always in the same way. So the surfaces
// are those of other isovalues, off by at most h/2, as closed and as correctly ordered as before; of several within one step the
// places coincide. The share `t` is off by at most h/|s_b − s_f| besides. Scalars outside of low..high count as its ends:
// surfaces there are lost. tests/isosurface_test.cpp.
class IsoSurfaceTable {
public:
    struct Texel {
        float color[3];  // all crossed surfaces, composited from front to back, unlit: associated
        float opacity;
        float t;  // where the first one is crossed, 0..1; 0 where none is
    };

    // Finite low < high; n: 2 .. 4096. Time and memory grow with n² (20 bytes a texel), not with the number of surfaces.
    IsoSurfaceTable(const IsoSurfaces& surfaces, double low, double high, int n);

    int size() const { return size_; }
    int intervals() const { return size_ - 1; }
    double step() const { return (high_ - low_) / intervals(); }
    // The scalar at the table's position i, 0 .. n − 1, and the nearest position to a scalar.
    double scalar(int i) const { return scalar_at(low_, high_, size_, i); }
    static double scalar_at(double low, double high, int n, int i);
    int position(double s) const;
    const std::vector<Texel>& texels() const { return texels_; }  // (i, j) for (s_f, s_b) at i + n·j
    const Texel& lookup(double s_f, double s_b) const;

private:
    double low_, high_;
    int size_;
    std::vector<Texel> texels_;
};

}  // namespace cellproj
