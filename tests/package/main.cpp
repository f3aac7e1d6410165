// SPDX-License-Identifier: BSD-3-Clause
//
// The smallest program around cellproj, built by tests/check_package.sh: one tetrahedron, put in order for one eye.
#include <cstdio>

#include "mesh/tet_mesh.hpp"
#include "sort/visibility_sorter.hpp"

int main() {
    cellproj::TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    cellproj::validate(mesh, "one tetrahedron");

    std::printf("order:");
    for (const cellproj::CellId cell : cellproj::order_cells(mesh, cellproj::Eye::at({3, 4, 5})))
        std::printf(" %u", cell);
    std::printf("\n");
}
