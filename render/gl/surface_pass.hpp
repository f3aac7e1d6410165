// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces in OpenGL (shaders/surfaces.frag): what the scene's surfaces and lights are to the fragments. Which cells they cross, which
// of them are seen and whether they want an order is known to PreparedScene.
#pragma once

#include <string>

#include "render/cell_stream.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/textures.hpp"
#include "render/renderer.hpp"

namespace cellproj::gl {

class SurfacePass {
public:
    // Throws Error (option) for surfaces with a method of light at the vertices or blended by halves, which know no place in a
    // segment.
    static void require_drawn(const Scene& scene, const Quality& quality);

    // Of a scene that has_surfaces, as they are now; it must outlive this.
    explicit SurfacePass(const PreparedScene& prepared);

    // What is defined and bound follows the scene's transfer function of the moment.
    struct Variant {
        bool nearest;   // NEAREST: the nearest surface of each pixel is all that is drawn
        bool windowed;  // WINDOW: rays are cut
    };
    std::string defines(bool perspective, bool nearest) const;  // without WINDOW
    void bind(const Program& program, const CellStream& cells, const NearnessFrame& frame, Variant variant) const;

private:
    const SurfaceScene& scene() const { return prepared_.surfaces()->scene(); }

    const PreparedScene& prepared_;
    Texture list_, lights_;
};

}  // namespace cellproj::gl
