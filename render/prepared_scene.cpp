// SPDX-License-Identifier: BSD-3-Clause
#include "render/prepared_scene.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

SceneUnits find_units(const Scene& scene) {
    assert(scene.mesh && scene.field && scene.transfer);
    const auto& [mesh, field] = std::tie(*scene.mesh, *scene.field);
    const std::size_t rows = field.location == FieldLocation::points ? mesh.points.size() : mesh.tets.size();
    if (field.values.size() != rows) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", std::to_string(rows) + " values",
                     std::to_string(field.values.size()), "choose a field of this mesh"});
    }
    const ScalarRange values = range(field.values);
    if (values.not_finite == field.values.size()) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", "finite values", "none", "choose another field"});
    }
    const double half_diagonal = bounds(mesh.points).diagonal() / 2;
    return {half_diagonal > 0 ? half_diagonal : 1.0, values.low, values.high};
}

double find_mean_chord(const TetMesh& mesh, double unit) {
    double volume = 0.0, surface = 0.0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        volume += std::abs(signed_volume(mesh, cell)) / (unit * unit * unit);
        for (int face = 0; face < 4; ++face) {
            const auto v = face_vertices(mesh.tets[cell], face);
            const glm::dvec3 a = (mesh.points[v[1]] - mesh.points[v[0]]) / unit;
            const glm::dvec3 b = (mesh.points[v[2]] - mesh.points[v[0]]) / unit;
            surface += glm::length(glm::cross(a, b)) / 2;
        }
    }
    const double chord = surface > 0.0 ? 4.0 * volume / surface : 0.0;
    return chord > 0.0 ? chord : 1.0;  // flat cells only: nothing is drawn
}

std::vector<std::uint8_t> find_visible(const Scene& scene) {
    const TetMesh& mesh = *scene.mesh;
    std::vector<std::uint8_t> visible(mesh.tets.size());
    const auto look = [&](const oneapi::tbb::blocked_range<std::size_t>& cells) {
        for (std::size_t c = cells.begin(); c != cells.end(); ++c) {
            double low = scene.field->at(mesh, static_cast<CellId>(c), 0), high = low, sum = low;
            for (int corner = 1; corner < 4; ++corner) {
                const double s = scene.field->at(mesh, static_cast<CellId>(c), corner);
                low = std::min(low, s);
                high = std::max(high, s);
                sum += 0.25 * s;
            }
            visible[c] = std::isfinite(sum) && scene.transfer->visible(low, high);
        }
    };
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, visible.size(), 4096), look);
    return visible;
}

}  // namespace

PreparedScene::PreparedScene(Scene scene)
    : scene_(std::move(scene)), units_(find_units(scene_)), sorter_(*scene_.mesh),
      mean_chord_(find_mean_chord(*scene_.mesh, units_.length)),
      visible_(find_visible(scene_)) {}

void PreparedScene::set_transfer(std::shared_ptr<const TransferFunction> transfer) {
    scene_.transfer = std::move(transfer);
    visible_ = find_visible(scene_);
}

}  // namespace cellproj
