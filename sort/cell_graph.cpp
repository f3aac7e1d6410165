// SPDX-License-Identifier: BSD-3-Clause
#include "sort/cell_graph.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <glm/common.hpp>

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;

constexpr std::size_t cells_per_task = 4096;
constexpr std::size_t cells_per_block = 64;  // whose corners fit into the first cache

constexpr VertexId no_point = std::numeric_limits<VertexId>::max();

// Spreads the lowest 21 bits to every third one.
std::uint64_t spread(std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

std::uint64_t morton_code(const glm::dvec3& unit) {
    const auto bits = [](double x) { return spread(static_cast<std::uint64_t>(std::clamp(x, 0.0, 1.0) * 0x1fffff)); };
    return bits(unit.x) | bits(unit.y) << 1 | bits(unit.z) << 2;
}

// Whether neighbours are near each other in the order of the cells. In a grid in rows and in Morton order their mean distance is about
// T^(2/3), a layer; in random order it is T/3.
bool coherent(const Adjacency& adjacency) {
    double distance = 0.0, faces = 0.0;
    for (std::size_t cell = 0; cell < adjacency.neighbours.size(); ++cell) {
        for (const CellId other : adjacency.neighbours[cell]) {
            if (other == no_cell) continue;
            distance += std::abs(static_cast<double>(other) - static_cast<double>(cell));
            faces += 1;
        }
    }
    return distance <= 2.0 * faces * std::pow(static_cast<double>(adjacency.neighbours.size()), 2.0 / 3.0);
}

// Whether the vertices of a cell are near each other among the points: then they need no numbers of their own. The bound is that of
// coherent() above.
bool points_are_coherent(const TetMesh& mesh) {
    if (mesh.points.size() > mesh.tets.size()) return false;  // most of them may belong to no cell
    double distance = 0.0;
    for (const auto& tet : mesh.tets) {
        const auto [low, high] = std::minmax({tet[0], tet[1], tet[2], tet[3]});
        distance += static_cast<double>(high - low);
    }
    return distance <= 2.0 * static_cast<double>(mesh.tets.size()) * std::pow(static_cast<double>(mesh.points.size()), 2.0 / 3.0);
}

std::vector<CellId> morton_order(const TetMesh& mesh) {
    struct Key {
        std::uint64_t code;
        CellId cell;
        bool operator<(const Key& other) const { return code != other.code ? code < other.code : cell < other.cell; }
    };
    const Bounds box = bounds(mesh.points);
    const double size = std::max({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z});
    std::vector<Key> keys(mesh.tets.size());
    oneapi::tbb::parallel_for(Range(0, keys.size(), cells_per_task), [&](const Range& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            glm::dvec3 sum(0.0);
            for (const VertexId v : mesh.tets[c]) sum += 0.25 * (mesh.points[v] - box.low);
            keys[c] = {size > 0 ? morton_code(sum / size) : 0, static_cast<CellId>(c)};
        }
    });
    oneapi::tbb::parallel_sort(keys.begin(), keys.end());
    std::vector<CellId> cells(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) cells[i] = keys[i].cell;
    return cells;
}

// The face of `place` that looks at `other` and has the vertices of face i there; 4 if there is none.
int face_towards(const std::array<CellId, 4>& neighbours, CellId other, const std::array<std::uint32_t, 4>& corners,
                 std::array<std::uint32_t, 3> vertices) {
    std::sort(vertices.begin(), vertices.end());
    for (int face = 0; face < 4; ++face) {
        if (neighbours[static_cast<std::size_t>(face)] != other) continue;
        auto mine = face_vertices(corners, face);
        std::sort(mine.begin(), mine.end());
        if (mine == vertices) return face;
    }
    return 4;
}

// Whether two lists of the same three vertices turn in opposite ways.
bool turn_oppositely(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
    return (a[0] == b[0] && a[1] == b[2]) || (a[0] == b[1] && a[1] == b[0]) || (a[0] == b[2] && a[1] == b[1]);
}

}  // namespace

// The eye in the coordinates of points_.
struct CellGraph::View {
    const Eye& eye;
    glm::vec3 xyz;
    bool at_infinity;
    float bound;  // 2⁻²⁴·R, see relate()
};

CellGraph::CellGraph(const TetMesh& mesh, const Adjacency& adjacency) : mesh_(mesh) {
    assert(adjacency.neighbours.size() == mesh.tets.size());
    const Bounds box = bounds(mesh.points);
    if (!mesh.points.empty()) {
        center_ = box.center();
        const glm::dvec3 reach = glm::max(box.high - center_, center_ - box.low);
        const double radius = std::max({reach.x, reach.y, reach.z});
        if (radius > 0) scale_ = std::ldexp(1.0, -std::ilogb(radius) - 1);
    }
    number_cells(adjacency);
    find_points();
    find_sides();
}

void CellGraph::number_cells(const Adjacency& adjacency) {
    const std::size_t count = mesh_.tets.size();
    keeps_order_ = coherent(adjacency);
    std::vector<CellId> place;
    if (!keeps_order_) {
        cells_ = morton_order(mesh_);
        place.resize(count);
        oneapi::tbb::parallel_for(Range(0, count, cells_per_task), [&](const Range& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) place[cells_[i]] = static_cast<CellId>(i);
        });
    }
    neighbours_.resize(count);
    oneapi::tbb::parallel_for(Range(0, count, cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            for (std::size_t face = 0; face < 4; ++face) {
                const CellId other = adjacency.neighbours[cell(static_cast<CellId>(i))][face];
                neighbours_[i][face] = other == no_cell ? static_cast<CellId>(count) : keeps_order_ ? other : place[other];
            }
        }
    });
}

void CellGraph::release_points() {
    std::vector<glm::vec4>().swap(points_);
    std::vector<std::array<std::uint32_t, 4>>().swap(own_corners_);
}

void CellGraph::find_points() {
    if (!points_.empty()) return;
    const auto in_floats = [&](VertexId vertex) { return glm::vec4(glm::vec3((mesh_.points[vertex] - center_) * scale_), 0.0F); };
    if (keeps_order_ && points_are_coherent(mesh_)) {
        points_.resize(mesh_.points.size());
        for (std::size_t i = 0; i < points_.size(); ++i) points_[i] = in_floats(static_cast<VertexId>(i));
        return;
    }
    own_corners_.resize(size());
    std::vector<std::uint32_t> number(mesh_.points.size(), no_point);
    for (std::size_t i = 0; i < size(); ++i) {
        const auto& tet = mesh_.tets[cell(static_cast<CellId>(i))];
        for (std::size_t corner = 0; corner < 4; ++corner) {
            std::uint32_t& n = number[tet[corner]];
            if (n == no_point) {
                n = static_cast<std::uint32_t>(points_.size());
                points_.push_back(in_floats(tet[corner]));
            }
            own_corners_[i][corner] = n;
        }
    }
    points_.shrink_to_fit();
}

// On which side of each of its faces does a cell lie? Inside, unless it is inverted. A flat cell lies on neither: it takes the side that
// its neighbour does not, so that those on its two sides are related through it.
void CellGraph::find_sides() {
    std::vector<std::int8_t> orientations(size());
    faces_.resize(size());
    const auto* const corners = this->corners();
    oneapi::tbb::parallel_for(Range(0, size(), cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto& t = mesh_.tets[cell(static_cast<CellId>(i))];
            const auto& p = mesh_.points;
            orientations[i] = static_cast<std::int8_t>(orientation(p[t[0]], p[t[1]], p[t[2]], p[t[3]]));
        }
    });
    for (std::size_t i = 0; i < size(); ++i) {
        if (orientations[i] == 0) flat_.push_back(static_cast<CellId>(i));
    }

    std::vector<std::uint8_t> folded(size());  // a bit per face
    oneapi::tbb::parallel_for(Range(0, size(), cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto place = static_cast<CellId>(i);
            const int own = orientations[i];
            unsigned outside = own < 0 ? 0xfU : 0U, inner = 0;
            for (int face = 0; face < 4; ++face) {
                const CellId other = neighbours_[i][static_cast<std::size_t>(face)];
                if (other == nobody()) continue;
                inner |= 1U << face;
                const auto mine = face_vertices(corners[i], face);
                const int back = face_towards(neighbours_[other], place, corners[other], mine);
                if (back == 4) {  // no face of theirs: no relation
                    folded[i] |= static_cast<std::uint8_t>(1U << face);
                    continue;
                }
                const int others = orientations[other];
                const bool opposite = turn_oppositely(mine, face_vertices(corners[other], back));
                if (own != 0 && others != 0 && opposite != (own == others)) folded[i] |= static_cast<std::uint8_t>(1U << face);
                if (own == 0 && others != 0 && opposite != (others > 0)) outside |= 1U << face;
                // Between two flat cells any rule will do that both follow.
                if (own == 0 && others == 0 && !opposite && place > other) outside |= 1U << face;
            }
            faces_[i] = static_cast<std::uint8_t>(outside | inner << 4);
        }
    });
    std::size_t folded_sides = 0;
    for (std::size_t i = 0; i < size(); ++i) {
        for (std::size_t face = 0; folded[i] != 0 && face < 4; ++face) {
            if ((folded[i] >> face & 1) == 0) continue;
            ++folded_sides;
            neighbours_[i][face] = nobody();
            faces_[i] &= static_cast<std::uint8_t>(~(0x10U << face));
        }
    }
    folded_faces_ = (folded_sides + 1) / 2;
}

int CellGraph::beyond(const Eye& eye, CellId place, int face) const {
    const auto v = face_vertices(mesh_.tets[cell(place)], face);
    const auto& p = mesh_.points;
    const int side = side_of_plane(eye, p[v[0]], p[v[1]], p[v[2]]);
    return (faces_[place] >> face & 1) != 0 ? -side : side;
}

bool CellGraph::is_flat(CellId place) const { return std::binary_search(flat_.begin(), flat_.end(), place); }

glm::dvec3 CellGraph::scaled(const Eye& eye) const {
    if (!eye.at_infinity) return (eye.xyz - center_) * scale_;
    return eye.xyz / std::max({std::abs(eye.xyz.x), std::abs(eye.xyz.y), std::abs(eye.xyz.z)});
}

void CellGraph::find_centroids(CellId first, std::span<glm::vec4> centroids) const {
    const auto* const corner = corners() + first;
    const glm::vec4* const points = points_.data();
    for (std::size_t k = 0; k < centroids.size(); ++k) {
        centroids[k] = 0.25F * (points[corner[k][0]] + points[corner[k][1]] + points[corner[k][2]] + points[corner[k][3]]);
    }
}

CellGraph::View CellGraph::view_from(const Eye& eye) const {
    const glm::dvec3 e = scaled(eye);
    const double reach = std::max({std::abs(e.x), std::abs(e.y), std::abs(e.z)});
    const double r = eye.at_infinity ? 1.0 : reach + 1.0;
    return {eye, glm::vec3(e), eye.at_infinity, static_cast<float>(r * 0x1p-24 * 1.001)};
}

void CellGraph::find_relations(const Eye& eye, std::span<Relations> relations) const {
    assert(relations.size() == size() + 1);
    const View view = view_from(eye);
    oneapi::tbb::parallel_for(Range(0, size(), cells_per_task), [&](const Range& range) {
        for (std::size_t begin = range.begin(); begin < range.end(); begin += cells_per_block) {
            relate(view, std::min(cells_per_block, range.end() - begin), [&](std::size_t k) { return begin + k; },
                   [&](std::size_t k, unsigned positive, unsigned negative) {
                       relations[begin + k] = relations_at(view, begin + k, positive, negative);
                   });
        }
    });
    relations[size()] = 0;
}

void CellGraph::find_relations(const Eye& eye, std::span<const CellId> places, std::span<Relations> relations,
                               std::span<float> reach) const {
    assert(relations.size() == places.size() && reach.size() == places.size());
    const View view = view_from(eye);
    for (std::size_t begin = 0; begin < places.size(); begin += cells_per_block) {
        relate(view, std::min(cells_per_block, places.size() - begin), [&](std::size_t k) { return places[begin + k]; },
               [&](std::size_t k, unsigned positive, unsigned negative, float cell_reach) {
                   relations[begin + k] = relations_at(view, places[begin + k], positive, negative);
                   reach[begin + k] = cell_reach;
               });
    }
}

// With edges u, v, w from the first corner and r from there to the eye (or its direction), the sides of the faces are
//   −[u v r] (face 3), [u w r] (2), −[v w r] (1), and [v w r] − [u w r] + [u v r] − [u v w] (0; without the last term for a direction).
// Bound: h = 2⁻²⁴. Points are rounded to within h/2 per coordinate, so edges of at most L per coordinate are good to h(1 + L), and r, at
// most R per coordinate, to 2hR. A determinant moves by no more than 6(2h(1 + L)·L·R + 2hR·L²) and terms of h², its evaluation
// adds 30·h·L²·R: together less than hR(54 L² + 12 L + 60 h). Face 0 sums four of them, [u v w] being within twice that bound as
// L ≤ 2R, and rounds three times: less than 7 times the bound.
// Reach: a determinant is linear in the eye, with gradient u × v, so its sign holds while the eye moves by less than its size, less the
// bound, over |u × v|. A component of that is good to 4h(1 + L)·L + 4hL² and terms of h², the length to √3 times as much: less
// than h(7 L + 14 L²), here doubled for the rounding of the length itself. Face 0's gradient is the sum of the three. The last factor
// is for the rounding of the quotient.
//
// `take` gets the number of a cell and, a bit per face, what float32 proves; where it wants the reach, that too.
template <class PlaceOf, class Take>
void CellGraph::relate(const View& view, std::size_t count, PlaceOf place_of, Take take) const {
    constexpr bool with_reach = std::is_invocable_v<Take, std::size_t, unsigned, unsigned, float>;
    constexpr std::size_t n = cells_per_block;
    float ux[n], uy[n], uz[n], vx[n], vy[n], vz[n], wx[n], wy[n], wz[n], rx[n], ry[n], rz[n];
    std::uint8_t positive[n], negative[n];
    [[maybe_unused]] float reach[n];
    [[maybe_unused]] constexpr std::size_t ahead = 16;  // cells, about the time that memory takes to answer
    const float origin = view.at_infinity ? 0.0F : 1.0F;
    const auto* const corners = this->corners();
    for (std::size_t k = 0; k < count; ++k) {
        const auto& corner = corners[place_of(k)];
        if constexpr (with_reach) __builtin_prefetch(&corners[place_of(std::min(k + ahead, count - 1))]);
        const glm::vec4 &a = points_[corner[0]], &b = points_[corner[1]], &c = points_[corner[2]], &d = points_[corner[3]];
        ux[k] = b.x - a.x, uy[k] = b.y - a.y, uz[k] = b.z - a.z;
        vx[k] = c.x - a.x, vy[k] = c.y - a.y, vz[k] = c.z - a.z;
        wx[k] = d.x - a.x, wy[k] = d.y - a.y, wz[k] = d.z - a.z;
        rx[k] = view.xyz.x - origin * a.x, ry[k] = view.xyz.y - origin * a.y, rz[k] = view.xyz.z - origin * a.z;
    }
    for (std::size_t k = 0; k < count; ++k) {
        const float uvx = uy[k] * vz[k] - uz[k] * vy[k], uvy = uz[k] * vx[k] - ux[k] * vz[k], uvz = ux[k] * vy[k] - uy[k] * vx[k];
        const float uwx = uy[k] * wz[k] - uz[k] * wy[k], uwy = uz[k] * wx[k] - ux[k] * wz[k], uwz = ux[k] * wy[k] - uy[k] * wx[k];
        const float vwx = vy[k] * wz[k] - vz[k] * wy[k], vwy = vz[k] * wx[k] - vx[k] * wz[k], vwz = vx[k] * wy[k] - vy[k] * wx[k];
        const float uvr = uvx * rx[k] + uvy * ry[k] + uvz * rz[k];
        const float uwr = uwx * rx[k] + uwy * ry[k] + uwz * rz[k];
        const float vwr = vwx * rx[k] + vwy * ry[k] + vwz * rz[k];
        const float uvw = origin * (uvx * wx[k] + uvy * wy[k] + uvz * wz[k]);
        const float bcd = ((vwr - uwr) + uvr) - uvw;
        const auto larger = [](float x, float y) { return x > y ? x : y; };
        const float longest =
            larger(larger(larger(std::abs(ux[k]), std::abs(uy[k])), larger(std::abs(uz[k]), std::abs(vx[k]))),
                   larger(larger(larger(std::abs(vy[k]), std::abs(vz[k])), larger(std::abs(wx[k]), std::abs(wy[k]))), std::abs(wz[k])));
        const float bound = view.bound * ((56.0F * longest + 13.0F) * longest + 0x1p-18F);
        const auto bits = [](bool f0, bool f1, bool f2, bool f3) {
            return static_cast<std::uint8_t>(static_cast<int>(f0) | static_cast<int>(f1) << 1 | static_cast<int>(f2) << 2 |
                                             static_cast<int>(f3) << 3);
        };
        positive[k] = bits(bcd > 7.0F * bound, -vwr > bound, uwr > bound, -uvr > bound);
        negative[k] = bits(-bcd > 7.0F * bound, vwr > bound, -uwr > bound, uvr > bound);
        if constexpr (with_reach) {
            const float slack = 0x1p-24F * (14.0F + 28.0F * longest) * longest;
            const auto length = [](float x, float y, float z) { return std::sqrt(x * x + y * y + z * z); };
            const auto smaller = [](float x, float y) { return x < y ? x : y; };
            const float reach0 = (std::abs(bcd) - 7.0F * bound) /
                                 (length((vwx - uwx) + uvx, (vwy - uwy) + uvy, (vwz - uwz) + uvz) + 4.0F * slack);
            const float reach1 = (std::abs(vwr) - bound) / (length(vwx, vwy, vwz) + slack);
            const float reach2 = (std::abs(uwr) - bound) / (length(uwx, uwy, uwz) + slack);
            const float reach3 = (std::abs(uvr) - bound) / (length(uvx, uvy, uvz) + slack);
            reach[k] = larger(smaller(smaller(reach0, reach1), smaller(reach2, reach3)) * (1.0F - 0x1p-20F), 0.0F);
        }
    }
    for (std::size_t k = 0; k < count; ++k) {
        if constexpr (with_reach) {
            take(k, positive[k], negative[k], reach[k]);
        } else {
            take(k, positive[k], negative[k]);
        }
    }
}

// Faces that float32 could not tell are asked exactly.
CellGraph::Relations CellGraph::relations_at(const View& view, std::size_t place, unsigned positive, unsigned negative) const {
    const unsigned outside = faces_[place] & 0xfU, inner = faces_[place] >> 4U;
    unsigned in_front_of = (positive & ~outside) | (negative & outside), hidden = (negative & ~outside) | (positive & outside);
    const unsigned unknown = inner & ~(positive | negative);
    for (unsigned faces = unknown; faces != 0; faces &= faces - 1) {
        const int face = std::countr_zero(faces);
        const int side = beyond(view.eye, static_cast<CellId>(place), face);
        if (side > 0) in_front_of |= 1U << face;
        if (side < 0) hidden |= 1U << face;
    }
    constexpr std::uint64_t ones = 0x4332322132212110ULL;  // in 15, 14, …, 0: baseline x86-64 has no instruction for it
    return static_cast<Relations>((in_front_of & inner) | static_cast<unsigned>(ones >> (4 * (hidden & inner)) & 0xfU) << 4);
}

}  // namespace cellproj
