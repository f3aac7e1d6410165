// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces in OpenGL (shaders/surfaces.frag): what the scene's surfaces and lights are to the fragments, and how the frame is drawn
// for them.
//
// "Model only what a scene requires": cells that no surface crosses are left out unless their medium is seen; without any medium
// none is integrated; and opaque surfaces alone are drawn in any order, by a depth test.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/cell_stream.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/textures.hpp"
#include "render/renderer.hpp"

namespace cellproj::gl {

class SurfacePass {
public:
    static bool is_needed(const Scene& scene);  // it has surfaces
    // Throws Error (option) for surfaces with a method of light at the vertices or blended by halves, which know no place in a
    // segment.
    static void require_drawn(const Scene& scene, const Quality& quality);

    // A scene that needs it, and that `validate` passes.
    SurfacePass(const Scene& scene, const SceneUnits& units);

    // The same surfaces, mesh and fields.
    bool is_of(const Scene& scene) const;
    // Which cells are seen without surfaces (PreparedScene::visible of a transfer function), before anything is drawn.
    void set_visible(std::shared_ptr<const TransferFunction> transfer, std::span<const std::uint8_t> visible);

    const SurfaceCells& cells() const { return cells_; }
    bool has_medium() const { return has_medium_; }
    bool needs_order() const { return has_medium_ || !opaque_; }
    std::span<const std::uint8_t> drawn() const { return drawn_; }  // #T, not empty
    ViewOrder any_order() const { return {drawn_items_, {}}; }      // of the cells drawn, when they need none

    std::string defines(bool perspective) const;
    // `windowed`: the variant WINDOW.
    void bind(const Program& program, const CellStream& cells, const NearnessFrame& frame, bool windowed) const;

private:
    Scene scene_;  // its transfer function: the one that `drawn_` is of
    SurfaceCells cells_;
    bool opaque_, two_fields_, has_medium_ = false;
    Shading shading_;
    Texture list_, lights_;
    std::vector<std::uint8_t> drawn_;
    std::vector<CellId> drawn_items_;
};

}  // namespace cellproj::gl
