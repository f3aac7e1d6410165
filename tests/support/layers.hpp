// SPDX-License-Identifier: BSD-3-Clause
//
// One pixel through many equal cells: what blending does to them, without any other error.
#pragma once

#include <memory>

#include "render/renderer.hpp"

namespace cellproj::testing_support {

// `count` tetrahedra one behind the other along z, from z = 0 to 1. Each is the hull of two crossing edges, so that the
// line x = y = 0 is in each of them for 1/count.
inline TetMesh stacked_cells(int count) {
    TetMesh mesh;
    for (int i = 0; i < count; ++i) {
        const double low = static_cast<double>(i) / count, high = static_cast<double>(i + 1) / count;
        const auto v = static_cast<VertexId>(mesh.points.size());
        for (const double end : {-1.0, 1.0}) mesh.points.emplace_back(end, 0, low);
        for (const double end : {-1.0, 1.0}) mesh.points.emplace_back(0, end, high);
        mesh.tets.push_back({v, v + 1, v + 2, v + 3});
    }
    orient_cells(mesh);
    return mesh;
}

// Along z, the line x = y = 0 at the centre of the middle pixel of a picture of odd size.
inline Camera view_along_z() {
    return {.projection = Camera::Projection::parallel, .eye = {0, 0, 3}, .center = {0, 0, 0}, .up = {0, 1, 0}, .height = 2.5};
}

// The middle pixel of a constant medium in `count` stacked cells, of length 1 in all.
inline glm::vec4 through_stacked_cells(Renderer& renderer, int count, const TransferFunction& medium, const Quality& quality) {
    const auto mesh = std::make_shared<TetMesh>(stacked_cells(count));
    const auto field = std::make_shared<ScalarField>(
        ScalarField{"s", FieldLocation::cells, std::vector<double>(mesh->tets.size(), 0.0)});
    const Scene scene{mesh, field, std::make_shared<TransferFunction>(medium)};
    return renderer.render(scene, view_along_z(), {31, 31}, quality).at(15, 15);
}

}  // namespace cellproj::testing_support
