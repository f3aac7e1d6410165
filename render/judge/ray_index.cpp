// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/ray_index.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "render/judge/ray_frame.hpp"

namespace cellproj {

namespace {

constexpr std::size_t leaf_cells = 4;         // at most
constexpr std::size_t parallel_cells = 8192;  // subtrees below are built by one thread

// Boxes are wider by this share of the mesh's size, some ten times the rounding of the box test and of the frame.
constexpr double box_margin = 1e-14;

struct Site {
    glm::vec3 center;  // of the cell, relative to the mesh's size: enough for a good tree
    CellId cell;
};

int widest_axis(const std::vector<Site>& sites, std::size_t begin, std::size_t end) {
    glm::vec3 low = sites[begin].center, high = low;
    for (std::size_t i = begin; i < end; ++i) {
        low = glm::min(low, sites[i].center);
        high = glm::max(high, sites[i].center);
    }
    const glm::vec3 extent = high - low;
    return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
}

int sign(double x) { return (x > 0) - (x < 0); }

// On which side of the line a → b the ray runs: the sign of the cross product, with the ray moved by (ε, ε²).
int side(double product, const FramePoint& a, const FramePoint& b) {
    if (product != 0) return sign(product);
    return a.v != b.v ? sign(a.v - b.v) : sign(b.u - a.u);
}

// The places of the four corners by ascending vertex: what two cells share they compute alike.
std::array<std::size_t, 4> by_vertex(const std::array<VertexId, 4>& v) {
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    const auto exchange = [&](std::size_t i, std::size_t j) {
        if (v[order[j]] < v[order[i]]) std::swap(order[i], order[j]);
    };
    exchange(0, 1);
    exchange(2, 3);
    exchange(0, 2);
    exchange(1, 3);
    exchange(1, 2);
    return order;
}

struct FaceHit {
    double t;
    std::array<double, 4> weights;
};

}  // namespace

struct RayIndex::Frame : RayFrame {
    double start;

    explicit Frame(const ViewRay& ray) : RayFrame(ray), start(ray.start) {}
};

RayIndex::RayIndex(const TetMesh& mesh) {
    validate(mesh, "mesh");
    const Bounds box = bounds(mesh.points);
    middle_ = box.center();
    const double size = box.diagonal() > 0 ? box.diagonal() : 1.0;
    points_.reserve(mesh.points.size());
    for (const glm::dvec3& p : mesh.points)
        points_.push_back(p - middle_);

    const std::size_t n = mesh.tets.size();
    while ((n >> levels_) >= leaf_cells)
        ++levels_;
    std::vector<Site> sites(n);
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, n, 4096), [&](const Range& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            glm::dvec3 center(0);
            for (const VertexId v : mesh.tets[c])
                center += points_[v] * (0.25 / size);
            sites[c] = {glm::vec3(center), static_cast<CellId>(c)};
        }
    });

    cells_.resize(n);
    boxes_.resize((std::size_t{2} << levels_) - 1);
    const auto build = [&](const auto& self, int level, std::size_t k) -> void {
        const std::size_t begin = first_cell(level, k), end = first_cell(level, k + 1);
        Box& own = boxes_[(std::size_t{1} << level) - 1 + k];
        if (level == levels_) {
            own = {glm::dvec3(std::numeric_limits<double>::infinity()), glm::dvec3(-std::numeric_limits<double>::infinity())};
            for (std::size_t i = begin; i < end; ++i) {
                cells_[i] = {mesh.tets[sites[i].cell], sites[i].cell};
                for (const VertexId v : cells_[i].vertices) {
                    own.low = glm::min(own.low, points_[v] - box_margin * size);
                    own.high = glm::max(own.high, points_[v] + box_margin * size);
                }
            }
            return;
        }
        const int axis = widest_axis(sites, begin, end);
        const auto at = [&](std::size_t i) { return sites.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(first_cell(level + 1, 2 * k + 1)), at(end), [axis](const Site& a, const Site& b) {
            return std::pair(a.center[axis], a.cell) < std::pair(b.center[axis], b.cell);
        });
        const auto left = [&] { self(self, level + 1, 2 * k); };
        const auto right = [&] { self(self, level + 1, 2 * k + 1); };
        if (end - begin > parallel_cells) {
            oneapi::tbb::parallel_invoke(left, right);
        } else {
            left();
            right();
        }
        const std::size_t child = (std::size_t{2} << level) - 1 + 2 * k;
        own = {glm::min(boxes_[child].low, boxes_[child + 1].low), glm::max(boxes_[child].high, boxes_[child + 1].high)};
    };
    build(build, 0, 0);
}

ViewRay RayIndex::slide(const ScreenTransform::Ray& relative, bool from_origin) const {
    const double along = -glm::dot(relative.origin, relative.direction);
    return {relative.origin + along * relative.direction, relative.direction,
            from_origin ? -along : -std::numeric_limits<double>::infinity()};
}

ViewRay RayIndex::ray(const Camera& camera, ImageSize size, const glm::dvec2& screen) const {
    Camera relative = camera;
    relative.eye -= middle_;
    relative.center -= middle_;
    return slide(ScreenTransform(relative, size).ray(screen), camera.projection == Camera::Projection::perspective);
}

ViewRay RayIndex::ray(const ScreenTransform::Ray& ray, bool from_origin) const {
    return slide({ray.origin - middle_, ray.direction}, from_origin);
}

// Calls visit(cell) for every cell whose box the ray meets, until it returns false.
template <class Visit>
void RayIndex::visit_candidates(const ViewRay& ray, Visit visit) const {
    glm::dvec3 inverse;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = ray.direction[axis];
        inverse[axis] = std::abs(d) > 1e-300 ? 1.0 / d : 1e300;  // no 0·infinity below
    }
    const auto meets_box = [&](const Box& box) {
        double near = ray.start, far = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            const double a = (box.low[axis] - ray.origin[axis]) * inverse[axis],
                         b = (box.high[axis] - ray.origin[axis]) * inverse[axis];
            near = std::max(near, std::min(a, b));
            far = std::min(far, std::max(a, b));
        }
        return near <= far;
    };
    struct Node {
        int level;
        std::size_t k;
    };
    std::array<Node, 64> stack;  // one sibling per level waits
    std::size_t waiting = 0;
    if (meets_box(boxes_[0])) stack[waiting++] = {0, 0};
    while (waiting > 0) {
        const Node node = stack[--waiting];
        if (node.level == levels_) {
            for (std::size_t i = first_cell(node.level, node.k), end = first_cell(node.level, node.k + 1); i < end; ++i) {
                if (!visit(cells_[i])) return;
            }
            continue;
        }
        const std::size_t child = (std::size_t{2} << node.level) - 1 + 2 * node.k;
        for (const std::size_t side : {1U, 0U}) {
            if (meets_box(boxes_[child + side])) stack[waiting++] = {node.level + 1, 2 * node.k + side};
        }
    }
}

bool RayIndex::cross(const Frame& frame, const Cell& cell, Crossing& crossing) const {
    std::array<FramePoint, 4> seen;
    for (std::size_t i = 0; i < 4; ++i)
        seen[i] = frame.see(points_[cell.vertices[i]]);
    // All on one side of the ray, most often.
    const auto extent = [&](double FramePoint::*x) {
        return std::pair(std::min(std::min(seen[0].*x, seen[1].*x), std::min(seen[2].*x, seen[3].*x)),
                         std::max(std::max(seen[0].*x, seen[1].*x), std::max(seen[2].*x, seen[3].*x)));
    };
    const auto [u_low, u_high] = extent(&FramePoint::u);
    const auto [v_low, v_high] = extent(&FramePoint::v);
    if (u_low > 0 || u_high < 0 || v_low > 0 || v_high < 0) return false;

    const auto order = by_vertex(cell.vertices);
    const std::array<FramePoint, 4> p{seen[order[0]], seen[order[1]], seen[order[2]], seen[order[3]]};
    double product[4][4];
    int sides[4][4];
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
            product[i][j] = cross_product(p[i], p[j]);
            sides[i][j] = side(product[i][j], p[i], p[j]);
        }
    }
    constexpr std::array<std::array<std::size_t, 3>, 4> faces{{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}};
    std::array<FaceHit, 2> hits;
    std::size_t found = 0;
    for (const auto& [a, b, c] : faces) {
        if (sides[a][b] == 0 || sides[a][b] != sides[b][c] || sides[a][b] != -sides[a][c]) continue;
        const double wa = std::abs(product[b][c]), wb = std::abs(product[a][c]), wc = std::abs(product[a][b]);
        const double sum = wa + wb + wc;
        if (!(sum > 0) || found == 2) continue;  // only where products underflow
        FaceHit& hit = hits[found++];
        hit.t = (wa / sum) * p[a].t + (wb / sum) * p[b].t + (wc / sum) * p[c].t;
        hit.weights = {};
        hit.weights[order[a]] = wa / sum;
        hit.weights[order[b]] = wb / sum;
        hit.weights[order[c]] = wc / sum;
    }
    if (found != 2) return false;
    if (hits[1].t < hits[0].t) std::swap(hits[0], hits[1]);
    if (!(hits[0].t < hits[1].t) || hits[1].t <= frame.start) return false;

    crossing = {cell.id, hits[0].t, hits[1].t, hits[0].weights, hits[1].weights};
    if (crossing.enter < frame.start) {
        const double share = (frame.start - crossing.enter) / crossing.length();
        for (std::size_t i = 0; i < 4; ++i)
            crossing.at_enter[i] += share * (crossing.at_leave[i] - crossing.at_enter[i]);
        crossing.enter = frame.start;
    }
    return true;
}

std::vector<Crossing> RayIndex::cells_along(const ViewRay& ray) const {
    const Frame frame(ray);
    std::vector<Crossing> crossings;
    Crossing crossing;
    visit_candidates(ray, [&](const Cell& cell) {
        if (cross(frame, cell, crossing)) crossings.push_back(crossing);
        return true;
    });
    // By the middle: where a cell is thinner than the rounding of t, its neighbour may begin or end an ulp on the wrong side.
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
        const double middle_a = a.enter + a.leave, middle_b = b.enter + b.leave;
        return middle_a != middle_b ? middle_a < middle_b : a.cell < b.cell;
    });
    return crossings;
}

bool RayIndex::meets(const ViewRay& ray) const {
    const Frame frame(ray);
    Crossing crossing;
    bool found = false;
    visit_candidates(ray, [&](const Cell& cell) { return !(found = cross(frame, cell, crossing)); });
    return found;
}

}  // namespace cellproj
