// SPDX-License-Identifier: BSD-3-Clause
#include "sort/cycles.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "sort/convex_part.hpp"
#include "sort/strong_components.hpp"

namespace cellproj {

namespace {

constexpr auto none = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t candidates_tried = 48;  // planes weighed per cut
constexpr std::size_t parts_weighed = 512;    // parts that a plane is weighed by, at most

std::array<glm::dvec3, 4> corners(const TetMesh& mesh, CellId cell) {
    const auto& t = mesh.tets[cell];
    return {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]};
}

double distance(const Eye& eye, const glm::dvec3& point) {
    return eye.at_infinity ? -glm::dot(eye.xyz, point) : glm::distance(eye.xyz, point);
}

struct Plane {
    glm::dvec3 a, b, c;
};

Plane face_plane(const TetMesh& mesh, CellId cell, int face) {
    const auto v = face_vertices(mesh.tets[cell], face);
    return {mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]};
}

// Heights of four points over a plane, with exact signs: where rounding gets a sign wrong, the point lies in the plane as far
// as heights can tell.
CornerHeights heights_over(const Plane& plane, const std::array<glm::dvec3, 4>& points) {
    const glm::dvec3 normal = glm::cross(plane.b - plane.a, plane.c - plane.a);
    CornerHeights heights;
    for (std::size_t i = 0; i < 4; ++i) {
        const double height = glm::dot(normal, points[i] - plane.a);
        const int sign = orientation(plane.a, plane.b, plane.c, points[i]);
        heights[i] = (sign > 0 && height > 0) || (sign < 0 && height < 0) ? height : 0.0;
    }
    return heights;
}

// The relations among a set of cells, from the one behind to the one in front, between their numbers in the set.
ArcRows relations_among(const CellGraph& graph, std::span<const CellId> places, std::span<const OrderArc> arcs, const Eye& eye) {
    std::vector<std::uint32_t> number(graph.size() + 1, none);
    for (std::uint32_t i = 0; i < places.size(); ++i)
        number[places[i]] = i;
    std::vector<std::array<std::uint32_t, 4>> in_front(places.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, places.size(), 2048), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            for (std::size_t face = 0; face < 4; ++face) {
                const std::uint32_t other = number[graph.neighbours(places[i])[face]];
                const bool hides = other != none && graph.beyond(eye, places[i], static_cast<int>(face)) > 0;
                in_front[i][face] = hides ? other : none;
            }
        }
    });
    std::vector<NodeArc> all;
    all.reserve(2 * places.size() + arcs.size());
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        for (const std::uint32_t j : in_front[i]) {
            if (j != none) all.push_back({i, j});
        }
    }
    for (const OrderArc& arc : arcs) {
        const std::uint32_t behind = number[arc.behind], front = number[arc.front];
        if (behind != none && front != none) all.push_back({behind, front});
    }
    return to_rows(all, places.size());
}

// A cell or what is left of it after cuts.
struct Part {
    std::uint32_t node;  // of the relations
    bool is_whole;
    ConvexPart shape;  // empty for a whole cell
};

class Resolver {
public:
    Resolver(const TetMesh& mesh, std::vector<CellId> cells, const ArcRows& relations, const Eye& eye, CutLimit limit, ResolvedCycles& result)
        : mesh_(mesh), cells_(std::move(cells)), relations_(relations), eye_(eye), limit_(limit), result_(result), slot_(cells_.size(), none),
          is_split_(cells_.size(), false), is_unordered_(cells_.size(), false) {}

    // Puts the cells of one component into the order.
    void resolve(std::span<const std::uint32_t> component) {
        // Flat cells hide nothing: what they are in is no cycle.
        const auto solid = component.size() == 1 ? 1 : std::count_if(component.begin(), component.end(), [&](std::uint32_t node) { return has_volume(node); });
        if (solid <= 1) {
            for (const std::uint32_t node : component)
                result_.items.push_back(cells_[node]);
            return;
        }
        ++result_.cycles;
        result_.cyclic_cells += component.size();
        std::size_t room = (limit_.per_cell - 1) * component.size() + limit_.spare;  // how many cuts are left
        std::vector<Part> all;
        for (const std::uint32_t node : component)
            all.push_back({node, true, {}});
        struct Task {
            std::vector<Part> parts;
            bool is_component;
        };
        std::vector<Task> tasks;  // the farthest last
        tasks.push_back({std::move(all), true});
        while (!tasks.empty()) {
            Task task = std::move(tasks.back());
            tasks.pop_back();
            if (task.parts.size() == 1) {
                emit(task.parts[0]);
            } else if (!task.is_component) {
                auto groups = components_of(std::move(task.parts));
                for (auto group = groups.rbegin(); group != groups.rend(); ++group)
                    tasks.push_back({std::move(*group), true});
            } else if (auto halves = cut_once(task.parts, room)) {
                tasks.push_back({std::move(halves->near), false});
                tasks.push_back({std::move(halves->far), false});
            } else {
                emit_by_depth(std::move(task.parts));
            }
        }
    }

private:
    struct Halves {
        std::vector<Part> far, near;
    };

    std::vector<std::vector<Part>> components_of(std::vector<Part> parts) {
        for (std::uint32_t i = 0; i < parts.size(); ++i)
            slot_[parts[i].node] = i;
        std::vector<NodeArc> arcs;
        for (std::uint32_t i = 0; i < parts.size(); ++i) {
            for (const std::uint32_t target : relations_.from(parts[i].node)) {
                if (slot_[target] != none) arcs.push_back({i, slot_[target]});
            }
        }
        for (const Part& part : parts)
            slot_[part.node] = none;
        const Components found = strong_components(to_rows(arcs, parts.size()));
        std::vector<std::vector<Part>> groups(found.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            for (const std::uint32_t i : found[k])
                groups[k].push_back(std::move(parts[i]));
        }
        return groups;
    }

    bool has_volume(std::uint32_t node) const {
        const auto p = corners(mesh_, cells_[node]);
        return orientation(p[0], p[1], p[2], p[3]) != 0;
    }

    PlaneSides sides_of(const Part& part, const CornerHeights& heights) const {
        static const ConvexPart whole = whole_cell();
        return sides(part.is_whole ? whole : part.shape, heights);
    }

    CornerHeights part_heights(const Part& part, const Plane& plane) const {
        return heights_over(plane, corners(mesh_, cells_[part.node]));
    }

    // Of planes that leave something on both sides, one that cuts few parts and halves the rest: in a long cycle the balance keeps
    // the tree low. Candidates are spread over the parts; with as many as there are faces each is tried. Nothing when no plane
    // parts them: the cells overlap.
    struct Choice {
        Plane plane;
        double cost;
    };
    std::optional<Choice> best_plane(const std::vector<Part>& parts, std::size_t candidates) const {
        std::optional<Choice> best;
        const std::size_t faces = 4 * parts.size(), tried = std::min(faces, candidates);
        const std::size_t step = parts.size() / parts_weighed + 1;
        for (std::size_t k = 0; k < tried; ++k) {
            const Plane plane = face_plane(mesh_, cells_[parts[parts.size() * k / tried].node], static_cast<int>(k % 4));
            std::size_t below = 0, above = 0, both = 0;
            for (std::size_t p = 0; p < parts.size(); p += step) {
                const PlaneSides side = sides_of(parts[p], part_heights(parts[p], plane));
                below += side.below && !side.above ? 1 : 0;
                above += side.above && !side.below ? 1 : 0;
                both += side.above && side.below ? 1 : 0;
            }
            if (below + both == 0 || above + both == 0) continue;
            const double cost = 2.0 * static_cast<double>(both) + std::abs(static_cast<double>(above) - static_cast<double>(below));
            if (!best || cost < best->cost) best = Choice{plane, cost};
        }
        return best;
    }

    std::optional<Halves> cut_once(std::vector<Part>& parts, std::size_t& room) {
        auto choice = best_plane(parts, candidates_tried);
        if (!choice) choice = best_plane(parts, 4 * parts.size());
        if (!choice) return std::nullopt;
        const Plane& plane = choice->plane;
        const bool eye_above = side_of_plane(eye_, plane.a, plane.b, plane.c) >= 0;
        Halves halves;
        std::size_t cuts = 0;
        std::vector<CornerHeights> heights;
        std::vector<PlaneSides> side;
        for (const Part& part : parts) {
            heights.push_back(part_heights(part, plane));
            side.push_back(sides_of(part, heights.back()));
            cuts += side.back().below && side.back().above ? 1 : 0;
        }
        if (cuts > room) return std::nullopt;
        room -= cuts;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            Part& part = parts[i];
            if (side[i].below && side[i].above) {
                result_.split_cells += is_split_[part.node] ? 0 : 1;
                is_split_[part.node] = true;
                CutPart two = cut(part.is_whole ? whole_cell() : part.shape, heights[i]);
                Part below{part.node, false, std::move(two.below)}, above{part.node, false, std::move(two.above)};
                (eye_above ? halves.far : halves.near).push_back(std::move(below));
                (eye_above ? halves.near : halves.far).push_back(std::move(above));
            } else {
                (side[i].above == eye_above ? halves.near : halves.far).push_back(std::move(part));
            }
        }
        return halves;
    }

    void emit(const Part& part) {
        const CellId cell = cells_[part.node];
        if (part.is_whole) {
            result_.items.push_back(cell);
            return;
        }
        const auto tets = tetrahedra(part.shape);
        for (const std::size_t i : back_to_front(cell, tets)) {
            result_.items.push_back(static_cast<std::uint32_t>(mesh_.tets.size() + result_.pieces.size()));
            result_.pieces.push_back({cell, tets[i]});
        }
    }

    // The tetrahedra of one convex part: those that share a face are ordered by its plane. Few, and acyclic (convex_part.cpp).
    std::vector<std::size_t> back_to_front(CellId cell, const std::vector<std::array<glm::dvec4, 4>>& tets) const {
        const auto p = corners(mesh_, cell);
        const auto place = [&](const glm::dvec4& w) {
            return p[0] + (w[1] * (p[1] - p[0]) + w[2] * (p[2] - p[0]) + w[3] * (p[3] - p[0]));
        };
        std::vector<NodeArc> arcs;
        for (std::uint32_t i = 0; i < tets.size(); ++i) {
            for (std::uint32_t j = 0; j < tets.size(); ++j) {
                if (i == j) continue;
                std::array<std::size_t, 4> shared{};
                std::size_t count = 0, apex = 0;
                for (std::size_t k = 0; k < 4; ++k) {
                    const bool is_shared = std::find(tets[j].begin(), tets[j].end(), tets[i][k]) != tets[j].end();
                    if (is_shared) shared[count++] = k;
                    else apex = k;
                }
                if (count != 3) continue;
                const glm::dvec3 a = place(tets[i][shared[0]]), b = place(tets[i][shared[1]]), c = place(tets[i][shared[2]]);
                if (side_of_plane(eye_, a, b, c) * orientation(a, b, c, place(tets[i][apex])) < 0) arcs.push_back({i, j});
            }
        }
        const Components order = strong_components(to_rows(arcs, tets.size()));
        return {order.members.begin(), order.members.end()};
    }

    void emit_by_depth(std::vector<Part> parts) {
        std::vector<std::pair<double, std::size_t>> by_depth;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const auto p = corners(mesh_, cells_[parts[i].node]);
            glm::dvec4 middle(0.25);
            if (!parts[i].is_whole) {
                middle = glm::dvec4(0);
                for (const glm::dvec4& w : parts[i].shape.vertices)
                    middle += w / static_cast<double>(parts[i].shape.vertices.size());
            }
            const glm::dvec3 at = p[0] + (middle[1] * (p[1] - p[0]) + middle[2] * (p[2] - p[0]) + middle[3] * (p[3] - p[0]));
            by_depth.emplace_back(-distance(eye_, at), i);
        }
        std::sort(by_depth.begin(), by_depth.end());
        for (const auto& [depth, i] : by_depth) {
            emit(parts[i]);
            const std::uint32_t node = parts[i].node;
            if (is_unordered_[node] || !has_volume(node)) continue;
            is_unordered_[node] = true;
            ++result_.unordered;
        }
    }

    const TetMesh& mesh_;
    std::vector<CellId> cells_;  // #nodes
    const ArcRows& relations_;
    const Eye& eye_;
    CutLimit limit_;
    ResolvedCycles& result_;
    std::vector<std::uint32_t> slot_;  // #nodes: where a node stands among the parts at hand, or none
    std::vector<bool> is_split_, is_unordered_;  // #nodes
};

}  // namespace

ResolvedCycles resolve_cycles(const CellGraph& graph, std::span<const CellId> places, std::span<const OrderArc> arcs, const Eye& eye,
                              CutLimit limit) {
    const ArcRows relations = relations_among(graph, places, arcs, eye);
    const Components components = strong_components(relations);
    std::vector<CellId> cells;
    cells.reserve(places.size());
    for (const CellId place : places)
        cells.push_back(graph.cell(place));
    ResolvedCycles result;
    result.items.reserve(places.size());
    Resolver resolver(graph.mesh(), std::move(cells), relations, eye, limit, result);
    for (std::size_t k = 0; k < components.size(); ++k)
        resolver.resolve(components[k]);
    return result;
}

}  // namespace cellproj
