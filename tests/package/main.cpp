// SPDX-License-Identifier: BSD-3-Clause
//
// A small program around cellproj, built by tests/check_package.sh: one tetrahedron, put in order for one eye and rendered.
#include <cstdio>
#include <memory>

#include "render/renderer.hpp"
#include "sort/visibility_sorter.hpp"

using namespace cellproj;

int main() {
    std::printf("order:");
    // README
    auto mesh = std::make_shared<TetMesh>(TetMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}, {}});
    auto field = std::make_shared<ScalarField>(ScalarField{"p", FieldLocation::points, {0.0, 0.3, 0.6, 1.0}});
    auto transfer = std::make_shared<TransferFunction>(default_transfer_function(0, 1, bounds(mesh->points).diagonal()));
    Camera camera = frame_bounds(bounds(mesh->points), Camera::Projection::perspective, {2, 1, 1}, {0, 0, 1}, 1.0);
    write_png(make_renderer(Backend::cpu)->render({mesh, field, transfer}, camera, {512, 512}), "tet.png");
    // end of README
    for (const CellId cell : order_cells(*mesh, camera.viewpoint()))
        std::printf(" %u", cell);
    std::printf("\n");
}
