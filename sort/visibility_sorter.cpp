// SPDX-License-Identifier: BSD-3-Clause
#include "sort/visibility_sorter.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// Grows with the distance from the eye; for an eye at infinity up to a constant and a factor.
double distance(const Eye& eye, const glm::dvec3& point) {
    return eye.at_infinity ? -glm::dot(eye.xyz, point) : glm::distance(eye.xyz, point);
}

// The distances that a mesh can have from an eye, mapped onto the depths of a DepthQueue.
class DepthScale {
public:
    DepthScale(const Bounds& box, const Eye& eye) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (int corner = 0; corner < 8; ++corner) {
            const double d = distance(eye, {corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                            corner & 4 ? box.high.z : box.low.z});
            low = std::min(low, d);
            high = std::max(high, d);
        }
        // A face or the inside of the box can be nearer than every corner, but never by more than its diagonal.
        if (!eye.at_infinity) low = std::max(0.0, std::min(low, high - box.diagonal()));
        low_ = low;
        scale_ = high > low ? (DepthQueue::depths - 1) / (high - low) : 0.0;
    }

    std::uint16_t operator()(double d) const {
        return static_cast<std::uint16_t>(std::clamp((d - low_) * scale_, 0.0, DepthQueue::depths - 1.0));
    }

private:
    double low_, scale_;
};

// Whether the eye lies beyond face i of a cell, on the neighbour's side: +1 yes, −1 no, 0 the face is edge-on. Computed with the
// exact predicate, hence the same for both cells of the face, up to the sign.
int beyond_face(const TetMesh& mesh, CellId cell, int face, const Eye& eye) {
    const auto v = face_vertices(mesh.tets[cell], face);
    return side_of_plane(eye, mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]);
}

glm::dvec3 centroid(const TetMesh& mesh, CellId cell) {
    const auto& t = mesh.tets[cell];
    return 0.25 * (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]]);
}

}  // namespace

VisibilitySorter::VisibilitySorter(const TetMesh& mesh, Adjacency adjacency)
    : mesh_(mesh), adjacency_(std::move(adjacency)) {
    assert(adjacency_.neighbours.size() == mesh.tets.size());
}

// Kahn's topological sort; where it stalls, the farthest cell left is released against its relations.
ViewOrder VisibilitySorter::order(const Eye& eye, OrderReport* report, std::optional<OrderMethod> /*method*/,
                                  const PixelGrid* /*pixels*/, std::span<const std::uint8_t> /*visible*/) {
    const std::size_t cells = mesh_.tets.size();
    find_relations(eye);
    free_.reset(cells);
    order_.clear();
    order_.reserve(cells);
    for (CellId cell = 0; cell < cells; ++cell) {
        if (behind_[cell] == 0) free_.push(cell, depth_[cell]);
    }
    drain();

    std::size_t unordered = 0;
    if (order_.size() < cells) {
        std::vector<CellId> blocked;
        for (CellId cell = 0; cell < cells; ++cell) {
            if (behind_[cell] != 0) blocked.push_back(cell);
        }
        std::stable_sort(blocked.begin(), blocked.end(), [&](CellId a, CellId b) { return depth_[a] > depth_[b]; });
        for (const CellId cell : blocked) {
            if (behind_[cell] == 0) continue;  // became free meanwhile
            ++unordered;
            behind_[cell] = 0;
            free_.push(cell, depth_[cell]);
            drain();
        }
    }
    if (report) *report = {.method = OrderMethod::mpvo, .exact = false, .unordered = unordered};
    return {order_, {}};
}

void VisibilitySorter::find_relations(const Eye& eye) {
    const std::size_t cells = mesh_.tets.size();
    in_front_.resize(cells);
    behind_.resize(cells);
    depth_.resize(cells);
    const DepthScale scale(bounds(mesh_.points), eye);
    const auto relate = [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            const auto cell = static_cast<CellId>(c);
            std::uint8_t in_front = 0, behind = 0;
            for (int face = 0; face < 4; ++face) {
                if (adjacency_.neighbours[c][static_cast<std::size_t>(face)] == no_cell) continue;
                const int beyond = beyond_face(mesh_, cell, face, eye);
                if (beyond > 0) in_front |= static_cast<std::uint8_t>(1U << face);
                if (beyond < 0) ++behind;
            }
            in_front_[c] = in_front;
            behind_[c] = behind;
            depth_[c] = scale(distance(eye, centroid(mesh_, cell)));
        }
    };
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, cells, 4096), relate);
}

// Puts the free cells into the order, farthest first, each of them freeing those that it was hidden by.
void VisibilitySorter::drain() {
    while (!free_.empty()) {
        const CellId cell = free_.pop_deepest();
        order_.push_back(cell);
        for (unsigned faces = in_front_[cell]; faces != 0; faces &= faces - 1) {
            release(adjacency_.neighbours[cell][static_cast<std::size_t>(std::countr_zero(faces))]);
        }
    }
}

void VisibilitySorter::release(CellId cell) {
    if (behind_[cell] == 0) return;  // already taken, to get out of a cycle
    if (--behind_[cell] == 0) free_.push(cell, depth_[cell]);
}

std::vector<CellId> order_cells(const TetMesh& mesh, const Eye& eye, OrderReport* report) {
    VisibilitySorter sorter(mesh);
    const ViewOrder order = sorter.order(eye, report);
    return {order.items.begin(), order.items.end()};
}

std::size_t count_order_violations(const TetMesh& mesh, const Adjacency& adjacency, const ViewOrder& order, const Eye& eye) {
    constexpr auto absent = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> position(mesh.tets.size(), absent);
    for (std::uint32_t i = 0; i < order.items.size(); ++i) {
        if (order.items[i] < mesh.tets.size()) position[order.items[i]] = i;
    }
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    const auto count = [&](const Range& range, std::size_t violations) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            const auto cell = static_cast<CellId>(c);
            for (int face = 0; face < 4; ++face) {
                const CellId other = adjacency.neighbours[cell][static_cast<std::size_t>(face)];
                if (other == no_cell || other < cell || position[cell] == absent || position[other] == absent) continue;
                const int beyond = beyond_face(mesh, cell, face, eye);
                // The neighbour on the eye's side must come later.
                if (beyond != 0 && (beyond > 0) != (position[other] > position[cell])) ++violations;
            }
        }
        return violations;
    };
    return oneapi::tbb::parallel_reduce(Range(0, mesh.tets.size(), 4096), std::size_t{0}, count, std::plus<>());
}

}  // namespace cellproj
