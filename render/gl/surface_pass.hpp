// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces, and media that are lit, in OpenGL (shaders/surfaces.frag): what the scene's surfaces and lights are to the fragments. Which cells they cross, which
// of them are seen and whether they want an order is known to PreparedScene.
#pragma once

#include <cstddef>
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

    // How the thresholds stand for a method (PreparedSurfaces).
    static SurfaceSides sides_for(const SurfaceMethod& method);

    // Of a scene that has_surface_scene, as they are now, with the sides of the method; it must outlive this.
    SurfacePass(const PreparedScene& prepared, const SurfaceMethod& method);

    const SurfaceMethod& method() const { return method_; }
    std::size_t table_bytes() const { return layers_.bytes() + first_.bytes(); }

    // What is defined and bound follows the scene's transfer function of the moment.
    struct Variant {
        bool nearest;   // NEAREST: the nearest surface of each pixel is all that is drawn
        bool windowed;  // WINDOW: rays are cut
    };
    std::string defines(bool perspective, bool nearest) const;  // without WINDOW
    void bind(const Program& program, const CellStream& cells, const NearnessFrame& frame, Variant variant) const;

private:
    const SurfaceScene& scene() const { return prepared_.surfaces()->scene(); }

    void upload_tables();

    const PreparedScene& prepared_;
    SurfaceMethod method_;
    Texture list_, lights_;
    Texture layers_, first_;  // over (s_f, s_b), of methods that take a table
};

}  // namespace cellproj::gl
