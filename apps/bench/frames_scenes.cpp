// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/frames_scenes.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <random>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj::bench {

namespace {

// The six tetrahedra of a box around its diagonal, one for each way along the edges from corner 0 to corner 7 (Kuhn 1960): the
// same in every box, so that they meet in common faces. Bit 0 of a corner is x, bit 1 y, bit 2 z.
constexpr std::array<std::array<int, 4>, 6> kuhn_tets{
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

TetMesh jittered_grid(int side) {
    constexpr double jitter = 0.2;
    const int boxes = side - 1;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> offset(-jitter / boxes, jitter / boxes);
    TetMesh mesh;
    for (int k = 0; k < side; ++k)
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                glm::dvec3 p = glm::dvec3(i, j, k) / static_cast<double>(boxes);
                const bool inner = std::min({i, j, k}) > 0 && std::max({i, j, k}) < boxes;
                for (int axis = 0; inner && axis < 3; ++axis) p[axis] += offset(random);
                mesh.points.push_back(p);
            }
    const auto id = [&](int i, int j, int k) { return static_cast<VertexId>((k * side + j) * side + i); };
    for (int k = 0; k < boxes; ++k)
        for (int j = 0; j < boxes; ++j)
            for (int i = 0; i < boxes; ++i)
                for (const auto& corners : kuhn_tets) {
                    std::array<VertexId, 4> tet{};
                    for (std::size_t v = 0; v < 4; ++v)
                        tet[v] = id(i + (corners[v] & 1), j + (corners[v] >> 1 & 1), k + (corners[v] >> 2 & 1));
                    mesh.tets.push_back(tet);
                }
    orient_cells(mesh);
    return mesh;
}

FieldMesh with_waves(TetMesh mesh) {
    ScalarField field = testing_support::point_field(mesh, scenes::waves);
    return {std::move(mesh), std::move(field), 0, 1};
}

FieldMesh bluntfin() {
    const std::filesystem::path data = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
    FieldMesh scene;
    scene.mesh = tetrahedralize(read(data / "bluntfinxyz.bin", {.solution = data / "bluntfinq.bin"}));
    scene.field = select_scalar(scene.mesh, "", "blunt fin");
    const ScalarRange scalars = range(scene.field.values);
    scene.low = scalars.low;
    scene.high = scalars.high;
    return scene;
}

// The number behind "grid:" or "delaunay:".
int number_behind(const std::string& name, std::size_t colon, int least, int most) {
    int value = 0;
    const char* end = name.data() + name.size();
    const auto [stop, failure] = std::from_chars(name.data() + colon + 1, end, value);
    if (failure != std::errc() || stop != end || value < least || value > most)
        throw Error({ErrorKind::option, "--scenes", "a number of points from " + std::to_string(least) + " to " + std::to_string(most) +
                     " behind the colon", "\"" + name + "\"", ""});
    return value;
}

}  // namespace

FieldMesh make_mesh(const std::string& name) {
    const auto colon = name.find(':');
    const std::string kind = name.substr(0, colon);
    if (kind == "grid" && colon != name.npos) return with_waves(jittered_grid(number_behind(name, colon, 2, 500)));
    if (kind == "delaunay" && colon != name.npos)
        return with_waves(testing_support::delaunay_mesh(number_behind(name, colon, 1, 10'000'000)));
    if (name == "bluntfin") return bluntfin();
    throw Error({ErrorKind::option, "--scenes", "grid:N, delaunay:N or bluntfin", "\"" + name + "\"", ""});
}

TransferFunction make_transfer(const std::string& name, const FieldMesh& scene) {
    // The mean edge of the box that has this diagonal: 1 for the unit cube.
    const double size = bounds(scene.mesh.points).diagonal() / std::sqrt(3.0);
    if (name == "ramp") return scenes::ramp(scene.low, scene.high, size);
    if (name == "peaks") return scenes::peaks(scene.low, scene.high, size);
    throw Error({ErrorKind::option, "--transfers", "ramp or peaks", "\"" + name + "\"", ""});
}

}  // namespace cellproj::bench
