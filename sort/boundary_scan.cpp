// SPDX-License-Identifier: BSD-3-Clause
#include "sort/boundary_scan.hpp"

#include <CGAL/Mpzf.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

using Exact = CGAL::Mpzf;

// Rows of a picture that one task scans.
constexpr int band_rows = 8;

// Roundings in one edge or depth function of a pixel: no more than 32 operations, each off by half an ulp of a term that the
// products of the bounds below cover.
constexpr double rounding = 32 * std::numeric_limits<double>::epsilon();

double size_of(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

// Pieces in contact whose coordinates were rounded, to float32 as a rule, may reach into each other by this share of their faces'
// edges (mesh/face_contacts.hpp calls them in contact up to as much): there, too, leaving comes before entering.
constexpr double contact = 1e-6;

int sign(double x) { return (x > 0) - (x < 0); }

// The ray of a pixel: origin + t·direction, t > 0 in perspective.
struct PixelRay {
    glm::dvec3 origin, direction;
};

// A function of the pixel (x, y), affine, and how far its value can be off.
struct AffineBound {
    double constant, x, y, error;

    double operator()(double px, double py) const { return constant + px * x + py * y; }
};

// The rays of a picture, and what the scan asks about them.
class Rays {
public:
    explicit Rays(const PixelGrid& grid) : grid_(grid), parallel_(grid.eye.at_infinity) {
        spread_ = grid.width * size_of(grid.dx) + grid.height * size_of(grid.dy);
    }

    const PixelGrid& grid() const { return grid_; }
    bool parallel() const { return parallel_; }

    PixelRay at(int i, int j) const {
        const glm::dvec3 p = grid_.corner + (i + 0.5) * grid_.dx + (j + 0.5) * grid_.dy;
        return parallel_ ? PixelRay{p, -grid_.eye.xyz} : PixelRay{grid_.eye.xyz, p - grid_.eye.xyz};
    }

    // det(a − o, b − o, d) of a pixel's ray: on which side of the edge a → b it passes.
    AffineBound edge(const glm::dvec3& a, const glm::dvec3& b) const {
        if (parallel_) {
            const glm::dvec3 u = a - grid_.corner, v = b - grid_.corner, d = -grid_.eye.xyz, n = glm::cross(v - u, d);
            return {glm::dot(glm::cross(u, v), d), -glm::dot(n, grid_.dx), -glm::dot(n, grid_.dy),
                    rounding * size_of(d) * (size_of(u) * size_of(v) + spread_ * (size_of(u) + size_of(v)))};
        }
        const glm::dvec3 u = a - grid_.eye.xyz, v = b - grid_.eye.xyz, n = glm::cross(u, v), c = grid_.corner - grid_.eye.xyz;
        return {glm::dot(n, c), glm::dot(n, grid_.dx), glm::dot(n, grid_.dy),
                rounding * size_of(u) * size_of(v) * (size_of(c) + spread_)};
    }

    // The exact sign of the same; never 0 unless the edge is seen as a point.
    int exact_edge_side(const glm::dvec3& a, const glm::dvec3& b, int i, int j) const {
        const PixelRay ray = at(i, j);
        // det(a − o, b − o, d) = det(d, a − o, b − o), the side of the plane through o, a, b that the direction points to.
        if (const int s = side_of_plane(Eye::towards(ray.direction), ray.origin, a, b)) return s;
        // Of the ray moved by (ε, ε²). Its derivatives keep their magnitude under exchange of a and b, so that both faces agree.
        for (const glm::dvec3& step : {grid_.dx, grid_.dy}) {
            const double derivative =
                parallel_ ? -glm::dot(glm::cross(b - a, ray.direction), step)
                          : 1.0 * side_of_plane(Eye::towards(step), ray.origin, a, b);
            if (derivative != 0) return sign(derivative);
        }
        return 0;
    }

    // Grows towards the eye along every ray: 1/t in perspective, −t in parallel views, for the plane of a face.
    AffineBound nearness(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double& relative_error) const {
        const glm::dvec3 u = b - a, v = c - a, n = glm::cross(u, v);
        const double size = size_of(u) * size_of(v);
        if (parallel_) {
            const glm::dvec3 d = -grid_.eye.xyz, w = a - grid_.corner;
            const double q = glm::dot(n, d);
            relative_error = rounding * size * size_of(d) / std::abs(q);
            return {-glm::dot(n, w) / q, glm::dot(n, grid_.dx) / q, glm::dot(n, grid_.dy) / q,
                    rounding * size * (size_of(w) + spread_) / std::abs(q)};
        }
        const glm::dvec3 w = a - grid_.eye.xyz, k = grid_.corner - grid_.eye.xyz;
        const double q = glm::dot(n, w);
        relative_error = rounding * size * size_of(w) / std::abs(q);
        return {glm::dot(n, k) / q, glm::dot(n, grid_.dx) / q, glm::dot(n, grid_.dy) / q,
                rounding * size * (size_of(k) + spread_) / std::abs(q)};
    }

private:
    PixelGrid grid_;
    bool parallel_;
    double spread_;  // of the pixels, from the corner [mesh units]
};

// A boundary face that is seen from one side.
struct SeenFace {
    std::array<VertexId, 3> vertices;  // so that rays through the inside have all three edges on the positive side
    CellId cell;
    bool is_entry;  // seen from the back: the cell begins here and goes on towards the eye
    std::array<AffineBound, 3> edges;
    AffineBound nearness;
    double relative_error;  // of the nearness, besides its absolute one
    int first_row, last_row;
    double first_column, last_column;
};

struct Fragment {
    double nearness;
    std::uint32_t face;
};

std::array<glm::dvec3, 3> places(const TetMesh& mesh, const SeenFace& face) {
    return {mesh.points[face.vertices[0]], mesh.points[face.vertices[1]], mesh.points[face.vertices[2]]};
}

// The sign of t_f − t_g, t where the ray meets the plane of a face, exactly: t = det(b−a, c−a, a−o) / det(b−a, c−a, d).
int compare_along_ray(const std::array<glm::dvec3, 3>& f, const std::array<glm::dvec3, 3>& g, const PixelRay& ray) {
    struct Quotient {
        Exact above, below;
    };
    const auto hit = [&](const std::array<glm::dvec3, 3>& p) {
        std::array<Exact, 3> u, v, w, d;
        for (int k = 0; k < 3; ++k) {
            const auto i = static_cast<std::size_t>(k);
            u[i] = Exact(p[1][k]) - Exact(p[0][k]);
            v[i] = Exact(p[2][k]) - Exact(p[0][k]);
            w[i] = Exact(p[0][k]) - Exact(ray.origin[k]);
            d[i] = Exact(ray.direction[k]);
        }
        const std::array<Exact, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        const auto along = [&](const std::array<Exact, 3>& x) { return n[0] * x[0] + n[1] * x[1] + n[2] * x[2]; };
        return Quotient{along(w), along(d)};
    };
    const Quotient a = hit(f), b = hit(g);
    const Exact difference = a.above * b.below - b.above * a.below;
    return static_cast<int>(CGAL::sign(difference)) * static_cast<int>(CGAL::sign(a.below)) *
           static_cast<int>(CGAL::sign(b.below));
}

// Where the rows and columns of a face can be: the box of its corners on the screen; the whole picture when one of them is not
// well in front of the eye.
void find_extent(const TetMesh& mesh, const Rays& rays, SeenFace& face) {
    const PixelGrid& grid = rays.grid();
    const glm::dvec3 n = glm::cross(grid.dx, grid.dy);
    const double plane = glm::dot(n, grid.corner - grid.eye.xyz);
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    const auto corners = places(mesh, face);
    // Every ray goes to the side of the eye where the pixels are.
    face.first_row = 0;
    face.last_row = -1;
    if (!rays.parallel() && std::all_of(corners.begin(), corners.end(), [&](const glm::dvec3& p) {
            const glm::dvec3 relative = p - grid.eye.xyz;
            return glm::dot(n, relative) * plane < -rounding * std::abs(plane) * size_of(relative) * size_of(grid.dx) * size_of(grid.dy);
        }))
        return;
    for (const glm::dvec3& p : corners) {
        // The point on the plane of the pixels that hides p.
        glm::dvec3 on_plane;
        if (rays.parallel()) {
            const glm::dvec3 d = grid.eye.xyz, relative = p - grid.corner;
            on_plane = relative - glm::dot(n, relative) / glm::dot(n, d) * d;
        } else {
            const glm::dvec3 relative = p - grid.eye.xyz;
            const double share = plane / glm::dot(n, relative);
            if (!(share > 0 && share < 1e6)) {
                low = glm::dvec2(0);
                high = glm::dvec2(grid.width, grid.height);
                break;
            }
            on_plane = share * relative - (grid.corner - grid.eye.xyz);
        }
        const double nn = glm::dot(n, n);
        const glm::dvec2 pixel(glm::dot(glm::cross(on_plane, grid.dy), n) / nn, glm::dot(glm::cross(grid.dx, on_plane), n) / nn);
        low = glm::min(low, pixel);
        high = glm::max(high, pixel);
    }
    // A pixel of margin, more than any rounding here. The centre of pixel i is i + ½.
    const auto clamp = [](double x, int size) { return static_cast<int>(std::clamp(x, -1.0, static_cast<double>(size))); };
    face.first_row = std::max(0, clamp(std::floor(low.y - 1.5), grid.height));
    face.last_row = std::min(grid.height - 1, clamp(std::ceil(high.y + 0.5), grid.height));
    face.first_column = std::max(0, clamp(std::floor(low.x - 1.5), grid.width));
    face.last_column = std::min(grid.width - 1, clamp(std::ceil(high.x + 0.5), grid.width));
}

// Scans some rows; one object per task, which keeps its memory to itself.
class BandScan {
public:
    BandScan(const TetMesh& mesh, const Rays& rays, std::span<const SeenFace> faces) : mesh_(mesh), rays_(rays), faces_(faces) {}

    void scan(std::span<const std::uint32_t> in_band, int first_row, int last_row) {
        const auto width = static_cast<std::size_t>(rays_.grid().width);
        std::vector<std::vector<Fragment>> row(width);
        for (int j = first_row; j <= last_row; ++j) {
            for (auto& list : row)
                list.clear();
            for (const std::uint32_t f : in_band) {
                if (faces_[f].first_row <= j && j <= faces_[f].last_row) cover(f, j, row);
            }
            for (std::size_t i = 0; i < width; ++i)
                relate(row[i], static_cast<int>(i), j);
        }
        std::sort(arcs.begin(), arcs.end());
        arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
    }

    std::vector<OrderArc> arcs;
    std::size_t crossed_rays = 0;

private:
    // Adds the face to the lists of the pixels of row j that it covers.
    void cover(std::uint32_t f, int j, std::vector<std::vector<Fragment>>& row) {
        const SeenFace& face = faces_[f];
        const double y = j + 0.5;
        // The columns where every edge function can be positive.
        double low = face.first_column, high = face.last_column;
        for (const AffineBound& e : face.edges) {
            const double start = e(0.5, y) + e.error;  // at column 0
            if (e.x > 0) low = std::max(low, -start / e.x - 1);
            if (e.x < 0) high = std::min(high, -start / e.x + 1);
            if (e.x == 0 && start < 0) return;
        }
        if (!(low <= high)) return;
        const int last = static_cast<int>(high);
        for (int i = static_cast<int>(low); i <= last; ++i) {
            const double x = i + 0.5;
            bool inside = true;
            for (std::size_t k = 0; k < 3 && inside; ++k) {
                const double value = face.edges[k](x, y);
                inside = std::abs(value) > face.edges[k].error ? value > 0 : exact_inside(face, k, i, j);
            }
            if (inside) row[static_cast<std::size_t>(i)].push_back({face.nearness(x, y), f});
        }
    }

    bool exact_inside(const SeenFace& face, std::size_t k, int i, int j) const {
        return rays_.exact_edge_side(mesh_.points[face.vertices[k]], mesh_.points[face.vertices[(k + 1) % 3]], i, j) > 0;
    }

    // Whether fragment a is farther than b, exactly.
    bool is_farther(const Fragment& a, const Fragment& b, int i, int j) const {
        const SeenFace &f = faces_[a.face], &g = faces_[b.face];
        const double error = f.nearness.error + g.nearness.error + f.relative_error * std::abs(a.nearness) +
                             g.relative_error * std::abs(b.nearness);
        if (std::abs(a.nearness - b.nearness) > error) return a.nearness < b.nearness;  // not when the error is not finite
        if (const int s = compare_along_ray(places(mesh_, f), places(mesh_, g), rays_.at(i, j))) return s > 0;
        // They meet here: on a ray moved by (ε, ε²) the slopes decide, unless these are the same plane as far as one can tell.
        for (double AffineBound::*slope : {&AffineBound::x, &AffineBound::y}) {
            const double difference = f.nearness.*slope - g.nearness.*slope;
            const double slope_error = f.nearness.error + g.nearness.error + f.relative_error * std::abs(f.nearness.*slope) +
                                       g.relative_error * std::abs(g.nearness.*slope);
            if (std::abs(difference) > slope_error) return difference < 0;
        }
        return g.is_entry && !f.is_entry;
    }

    // Puts the list of one pixel in order, from back to front, and takes the relations from it.
    void relate(std::vector<Fragment>& list, int i, int j) {
        std::sort(list.begin(), list.end(), [](const Fragment& a, const Fragment& b) {
            return a.nearness != b.nearness ? a.nearness < b.nearness : a.face < b.face;
        });
        // By rounded values so far. Neighbours that these cannot tell apart change places.
        for (std::size_t k = 1; k < list.size(); ++k) {
            for (std::size_t l = k; l > 0 && is_farther(list[l], list[l - 1], i, j); --l)
                std::swap(list[l], list[l - 1]);
        }
        bool crossed = false, inside = false;  // a ray comes from infinity
        for (std::size_t k = 0; k < list.size(); ++k) {
            if (inside && k + 1 < list.size() && is_entry(list[k]) && !is_entry(list[k + 1]) &&
                distance(list[k], list[k + 1], i, j) <= contact * std::min(longest_edge(list[k]), longest_edge(list[k + 1])))
                std::swap(list[k], list[k + 1]);
            crossed = crossed || inside == is_entry(list[k]);
            inside = is_entry(list[k]);
            if (k > 0 && inside && !is_entry(list[k - 1]) && cell(list[k - 1]) != cell(list[k])) add({cell(list[k - 1]), cell(list[k])});
        }
        crossed_rays += crossed ? 1 : 0;
    }

    bool is_entry(const Fragment& fragment) const { return faces_[fragment.face].is_entry; }
    CellId cell(const Fragment& fragment) const { return faces_[fragment.face].cell; }

    // Between two fragments of a pixel [mesh units].
    double distance(const Fragment& a, const Fragment& b, int i, int j) const {
        const double difference = rays_.parallel() ? a.nearness - b.nearness : 1 / a.nearness - 1 / b.nearness;
        return std::abs(difference) * glm::length(rays_.at(i, j).direction);
    }

    double longest_edge(const Fragment& fragment) const {
        const auto p = places(mesh_, faces_[fragment.face]);
        return std::max({glm::distance(p[0], p[1]), glm::distance(p[1], p[2]), glm::distance(p[2], p[0])});
    }

    // Neighbouring pixels see much the same.
    void add(const OrderArc& arc) {
        for (std::size_t back = 1; back <= std::min<std::size_t>(arcs.size(), 8); ++back) {
            if (arcs[arcs.size() - back] == arc) return;
        }
        arcs.push_back(arc);
    }

    const TetMesh& mesh_;
    const Rays& rays_;
    std::span<const SeenFace> faces_;
};

std::vector<SeenFace> seen_faces(const TetMesh& mesh, std::span<const BoundaryFace> boundary, const Rays& rays) {
    std::vector<SeenFace> faces(boundary.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, boundary.size(), 512), [&](const Range& range) {
        for (std::size_t b = range.begin(); b != range.end(); ++b) {
            const CellId cell = boundary[b].cell;
            SeenFace& face = faces[b];
            face.cell = no_cell;  // not seen
            face.vertices = face_vertices(mesh.tets[cell], boundary[b].face);
            auto p = places(mesh, face);
            // An eye in the plane sees nothing of the face.
            const int side = side_of_plane(rays.grid().eye, p[0], p[1], p[2]);
            if (side == 0) continue;
            // det(a−o, b−o, d) > 0 for all edges when a, b, c turn clockwise as seen from the eye.
            if (side > 0) std::swap(face.vertices[1], face.vertices[2]);
            p = places(mesh, face);
            find_extent(mesh, rays, face);
            if (face.first_row > face.last_row || face.first_column > face.last_column) continue;
            const auto& t = mesh.tets[cell];
            const int own = orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]);
            face.cell = cell;
            face.is_entry = side * own < 0;  // the eye is on the cell's side of the face
            for (std::size_t k = 0; k < 3; ++k)
                face.edges[k] = rays.edge(p[k], p[(k + 1) % 3]);
            face.nearness = rays.nearness(p[0], p[1], p[2], face.relative_error);
            if (!std::isfinite(face.nearness.constant)) face.nearness.constant = 0;  // edge-on: always decided exactly
        }
    });
    std::erase_if(faces, [](const SeenFace& face) { return face.cell == no_cell; });
    return faces;
}

}  // namespace

BoundaryScan scan_boundary(const TetMesh& mesh, std::span<const BoundaryFace> boundary, const PixelGrid& pixels) {
    const Rays rays(pixels);
    const std::vector<SeenFace> faces = seen_faces(mesh, boundary, rays);
    const auto bands = static_cast<std::size_t>((pixels.height + band_rows - 1) / band_rows);
    std::vector<std::vector<std::uint32_t>> in_band(bands);
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
        for (int band = faces[f].first_row / band_rows; band <= faces[f].last_row / band_rows; ++band)
            in_band[static_cast<std::size_t>(band)].push_back(f);
    }
    std::vector<BandScan> scans(bands, BandScan(mesh, rays, faces));
    oneapi::tbb::parallel_for(std::size_t{0}, bands, [&](std::size_t band) {
        const int first = static_cast<int>(band) * band_rows;
        scans[band].scan(in_band[band], first, std::min(first + band_rows, pixels.height) - 1);
    });

    BoundaryScan result;
    for (const BandScan& scan : scans) {
        result.arcs.insert(result.arcs.end(), scan.arcs.begin(), scan.arcs.end());
        result.crossed_rays += scan.crossed_rays;
    }
    std::sort(result.arcs.begin(), result.arcs.end());
    result.arcs.erase(std::unique(result.arcs.begin(), result.arcs.end()), result.arcs.end());
    return result;
}

}  // namespace cellproj
