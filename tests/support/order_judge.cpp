// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/order_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <unordered_map>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

namespace cellproj::testing_support {

namespace {

constexpr auto absent = std::numeric_limits<std::uint32_t>::max();

struct Stretch {
    double enter, leave;
    std::uint32_t position;  // in the order
};

ViewRay pixel_ray(const RayIndex& index, const PixelGrid& grid, double x, double y) {
    const glm::dvec3 p = grid.corner + x * grid.dx + y * grid.dy;
    const glm::dvec3 direction = grid.eye.at_infinity ? -grid.eye.xyz : p - grid.eye.xyz;
    return index.ray({grid.eye.at_infinity ? p : grid.eye.xyz, glm::normalize(direction)}, !grid.eye.at_infinity);
}

// Where a ray is inside a tetrahedron, by clipping with the four planes.
Stretch clip(const std::array<glm::dvec3, 4>& p, const ViewRay& ray) {
    Stretch inside{ray.start, std::numeric_limits<double>::infinity(), 0};
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec3 &a = p[(i + 1) % 4], &b = p[(i + 2) % 4], &c = p[(i + 3) % 4];
        glm::dvec3 inward = glm::cross(b - a, c - a);
        if (glm::dot(inward, p[i] - a) < 0) inward = -inward;
        const double speed = glm::dot(inward, ray.direction), height = glm::dot(inward, a - ray.origin);
        if (speed > 0) inside.enter = std::max(inside.enter, height / speed);
        if (speed < 0) inside.leave = std::min(inside.leave, height / speed);
        if (speed == 0 && height > 0) inside.leave = -std::numeric_limits<double>::infinity();
    }
    return inside;
}

}  // namespace

Camera judging_camera(const Bounds& box, int i, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const double a = normal(random), b = normal(random), c = normal(random);
    const glm::dvec3 from = i % 5 == 0 ? glm::dvec3(0, 0, 1) : glm::normalize(glm::dvec3(a, b, c));
    const glm::dvec3 up = std::abs(from.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    Camera camera = frame_bounds(box, i % 2 ? Camera::Projection::perspective : Camera::Projection::parallel, from, up, 1.0);
    if (i % 4 == 3) {
        camera.eye = box.center() + 0.1 * box.diagonal() * from;
        camera.center = camera.eye - box.diagonal() * from;
        camera.fov_y_degrees = 90;
    }
    return camera;
}

std::vector<ViewRay> random_pixel_rays(const RayIndex& index, const PixelGrid& grid, int count, std::mt19937_64& random) {
    std::uniform_int_distribution<int> column(0, grid.width - 1), row(0, grid.height - 1);
    std::vector<ViewRay> rays;
    for (int k = 0; k < count; ++k) {
        const int i = column(random), j = row(random);
        rays.push_back(pixel_ray(index, grid, i + 0.5, j + 0.5));
    }
    return rays;
}

std::vector<ViewRay> random_rays(const RayIndex& index, const PixelGrid& grid, int count, std::mt19937_64& random) {
    std::uniform_real_distribution<double> share;
    std::vector<ViewRay> rays;
    for (int k = 0; k < count; ++k) {
        const double x = share(random) * grid.width, y = share(random) * grid.height;
        rays.push_back(pixel_ray(index, grid, x, y));
    }
    return rays;
}

std::size_t wrong_rays(const TetMesh& mesh, const RayIndex& index, const ViewOrder& order, std::span<const ViewRay> rays) {
    const double shortest = 1e-9 * bounds(mesh.points).diagonal();
    std::vector<std::uint32_t> position(mesh.tets.size(), absent);
    std::unordered_map<CellId, std::vector<std::uint32_t>> pieces_of;  // places in the order
    for (std::uint32_t i = 0; i < order.items.size(); ++i) {
        const std::uint32_t item = order.items[i];
        if (item < mesh.tets.size()) position[item] = i;
        else pieces_of[order.pieces[item - mesh.tets.size()].cell].push_back(i);
    }
    const auto is_wrong = [&](const ViewRay& ray) {
        std::vector<Stretch> stretches;
        for (const Crossing& crossing : index.cells_along(ray)) {
            if (crossing.length() < shortest) continue;
            if (position[crossing.cell] != absent) {
                stretches.push_back({crossing.enter, crossing.leave, position[crossing.cell]});
                continue;
            }
            double filled = 0;
            const auto pieces = pieces_of.find(crossing.cell);
            if (pieces == pieces_of.end()) return true;  // lost
            for (const std::uint32_t i : pieces->second) {
                const CellPiece& piece = order.pieces[order.items[i] - mesh.tets.size()];
                std::array<glm::dvec3, 4> corners;
                for (std::size_t k = 0; k < 4; ++k) {
                    corners[k] = glm::dvec3(0);
                    for (std::size_t v = 0; v < 4; ++v)
                        corners[k] += piece.corners[k][static_cast<int>(v)] * (mesh.points[mesh.tets[crossing.cell][v]] - index.middle());
                }
                Stretch inside = clip(corners, ray);
                inside.position = i;
                if (inside.leave > inside.enter) filled += inside.leave - inside.enter;
                if (inside.leave - inside.enter >= shortest) stretches.push_back(inside);
            }
            // Slivers among the pieces are clipped to a thousandth of their length at worst.
            if (std::abs(filled - crossing.length()) > 100 * shortest + 1e-6 * crossing.length()) return true;
        }
        std::sort(stretches.begin(), stretches.end(),
                  [](const Stretch& a, const Stretch& b) { return a.enter + a.leave < b.enter + b.leave; });
        for (std::size_t k = 1; k < stretches.size(); ++k) {
            if (stretches[k].position > stretches[k - 1].position) return true;
        }
        return false;
    };
    const auto is_surely_wrong = [&](const ViewRay& ray) {
        if (!is_wrong(ray)) return false;
        const glm::dvec3 d = glm::abs(ray.direction);
        const glm::dvec3 least = d.x <= d.y && d.x <= d.z ? glm::dvec3(1, 0, 0) : d.y <= d.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
        const glm::dvec3 x = shortest * glm::normalize(glm::cross(ray.direction, least)), y = glm::cross(ray.direction, x);
        // Askew to axes, which faces like to follow.
        for (const glm::dvec3& step : {x + 0.37 * y, y - 0.37 * x, -x - 0.37 * y, 0.37 * x - y}) {
            if (!is_wrong({ray.origin + step, ray.direction, ray.start})) return false;
        }
        return true;
    };
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    return oneapi::tbb::parallel_reduce(
        Range(0, rays.size(), 64), std::size_t{0},
        [&](const Range& range, std::size_t wrong) {
            for (std::size_t i = range.begin(); i != range.end(); ++i)
                wrong += is_surely_wrong(rays[i]) ? 1 : 0;
            return wrong;
        },
        std::plus<>());
}

std::size_t count_order_violations(const TetMesh& mesh, const Adjacency& adjacency, const ViewOrder& order, const Eye& eye) {
    std::vector<std::uint32_t> position(mesh.tets.size(), absent);
    for (std::uint32_t i = 0; i < order.items.size(); ++i) {
        if (order.items[i] < mesh.tets.size()) position[order.items[i]] = i;
    }
    using Range = oneapi::tbb::blocked_range<CellId>;
    const auto count = [&](const Range& range, std::size_t wrong) {
        for (CellId cell = range.begin(); cell != range.end(); ++cell) {
            for (int face = 0; face < 4; ++face) {
                const CellId other = adjacency.neighbours[cell][static_cast<std::size_t>(face)];
                if (other == no_cell || other < cell || position[cell] == absent || position[other] == absent) continue;
                const auto v = face_vertices(mesh.tets[cell], face);
                const int side = side_of_plane(eye, mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]);
                wrong += (side > 0 && position[other] < position[cell]) || (side < 0 && position[cell] < position[other]) ? 1 : 0;
            }
        }
        return wrong;
    };
    return oneapi::tbb::parallel_reduce(Range(0, static_cast<CellId>(mesh.tets.size()), 4096), std::size_t{0}, count, std::plus<>());
}

bool is_complete(const TetMesh& mesh, const ViewOrder& order) {
    std::vector<double> filled(mesh.tets.size(), 0.0);
    std::vector<std::uint8_t> whole(mesh.tets.size(), 0);
    std::vector<std::uint8_t> piece_seen(order.pieces.size(), 0);
    for (const std::uint32_t item : order.items) {
        if (item < mesh.tets.size()) {
            if (whole[item]++) return false;
            continue;
        }
        const std::size_t i = item - mesh.tets.size();
        if (i >= order.pieces.size() || piece_seen[i]++) return false;
        const CellPiece& piece = order.pieces[i];
        for (const glm::dvec4& w : piece.corners) {
            for (int k = 0; k < 4; ++k) {
                if (!(w[k] >= 0 && w[k] <= 1)) return false;
            }
            if (std::abs(w[0] + w[1] + w[2] + w[3] - 1) > 1e-12) return false;
        }
        filled[piece.cell] += std::abs(glm::determinant(glm::dmat4(piece.corners[0], piece.corners[1], piece.corners[2], piece.corners[3])));
    }
    for (std::size_t c = 0; c < mesh.tets.size(); ++c) {
        if (whole[c] ? filled[c] != 0 : std::abs(filled[c] - 1) > 1e-9) return false;
    }
    return std::find(piece_seen.begin(), piece_seen.end(), 0) == piece_seen.end();
}

}  // namespace cellproj::testing_support
