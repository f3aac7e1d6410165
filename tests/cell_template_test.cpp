// SPDX-License-Identifier: BSD-3-Clause
#include "project/cell_template.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/grid.hpp"
#include "tests/support/box_faces.hpp"
#include "tests/support/tet_rays.hpp"

namespace cellproj {
namespace cell_template_test {

using testing_support::area;
using testing_support::corner;
using testing_support::hull_area;
using testing_support::overlaps;
using testing_support::Plane;
using testing_support::point_in;
using testing_support::Polygon;
using testing_support::seen_from_outside;

double det(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::dot(glm::cross(a, b), c);
}

// ---- What holds for every template ----

Polygon on_plane(const CellTemplate& shape, const TemplatePolygon& polygon, const Bounds& cell, const Plane& plane) {
    Polygon points;
    for (const std::uint8_t v : polygon.corners())
        points.push_back(plane(point_in(cell, shape.vertices()[v].front)));
    return points;
}

// Invariants of the data; and that the polygons tile the silhouette, whose area is given, to 1e-12 of it.
void expect_tiles(const CellTemplate& shape, const Bounds& cell, const Plane& plane, double silhouette) {
    double sum = 0;
    for (const TemplatePolygon& p : shape.polygons()) {
        ASSERT_TRUE(p.count == 3 || p.count == 4);
        const double own = area(on_plane(shape, p, cell, plane));
        ASSERT_GE(own, -1e-14 * silhouette);  // none turned over: slivers round
        sum += own;
        ASSERT_GT(seen_from_outside(cell, p.front_face, plane), 0);
        ASSERT_LT(seen_from_outside(cell, p.back_face, plane), 0);
        for (const std::uint8_t v : p.corners()) {
            ASSERT_LT(v, shape.vertex_count);
            ASSERT_EQ(shape.vertices()[v].front[p.front_face / 2], p.front_face % 2);
            ASSERT_EQ(shape.vertices()[v].back[p.back_face / 2], p.back_face % 2);
        }
    }
    ASSERT_NEAR(sum, silhouette, 1e-12 * silhouette);
    for (const TemplateVertex& v : shape.vertices()) {
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_TRUE(v.front[axis] >= 0 && v.front[axis] <= 1);
            ASSERT_TRUE(v.back[axis] >= 0 && v.back[axis] <= 1);
        }
        ASSERT_TRUE(v.interior || v.front == v.back);
    }
}

// ---- Parallel views ----

Bounds box(const glm::dvec3& edges) {
    return {glm::dvec3(0), edges};
}

double parallel_silhouette(const glm::dvec3& d, const glm::dvec3& h) {
    return (std::abs(d.x) * h.y * h.z + std::abs(d.y) * h.x * h.z + std::abs(d.z) * h.x * h.y) / glm::length(d);
}

// Tiles the silhouette; every interior pair lies on one ray, at the same distance; thickness integrates to the volume.
void expect_parallel(const glm::dvec3& d, const glm::dvec3& h) {
    const CellTemplate shape = parallel_template(d, h);
    const Plane plane(d, std::nullopt);
    ASSERT_NO_FATAL_FAILURE(expect_tiles(shape, box(h), plane, parallel_silhouette(d, h)));
    const glm::dvec3 ray = -glm::normalize(d);
    for (const TemplateVertex& v : shape.vertices()) {
        if (!v.interior) continue;
        const glm::dvec3 miss = (v.back - v.front) * h - shape.interior_thickness * ray;
        // Against the longest piece of a ray there is: coordinates in the cell round to its edges.
        ASSERT_LT(glm::length(miss), 1e-14 * glm::length(h));
    }
    double integral = 0;
    for (const TemplatePolygon& p : shape.polygons()) {
        const Polygon points = on_plane(shape, p, box(h), plane);
        const auto thickness = [&](std::size_t i) {
            return shape.vertices()[p.vertices[i]].interior ? shape.interior_thickness : 0.0;
        };
        for (std::size_t i = 2; i < points.size(); ++i)
            integral +=
                area({points[0], points[i - 1], points[i]}) * (thickness(0) + thickness(i - 1) + thickness(i)) / 3;
    }
    const double volume = h.x * h.y * h.z;
    ASSERT_NEAR(integral, volume, 1e-12 * parallel_silhouette(d, h) * shape.interior_thickness);
}

// What Fig. 1 of WVG91 says, from whole numbers.
struct Expected {
    int visible = 0;
    int ties = 0;  // axes that lead together: 1 face, 2 edge, 3 corner
    std::size_t polygons = 0;
    unsigned axes = 0;
};

Expected figure_1(const std::array<int, 3>& d, const std::array<int, 3>& h) {
    Expected e;
    for (std::size_t i = 0; i < 3; ++i) {
        if (d[i] == 0) continue;
        ++e.visible;
        bool leads = true;
        for (std::size_t j = 0; j < 3; ++j)
            leads = leads && std::abs(d[i]) * h[j] >= std::abs(d[j]) * h[i];
        e.ties += leads ? 1 : 0;
        e.axes |= leads ? 1U << i : 0U;
    }
    if (e.visible == 1) e.polygons = 1;
    if (e.visible == 2) e.polygons = e.ties == 1 ? 3 : 2;
    if (e.visible == 3) e.polygons = e.ties == 1 ? 7 : 6;
    return e;
}

template <class Visit>
void for_lattice(int low, int high, Visit visit) {
    for (int x = low; x <= high; ++x) {
        for (int y = low; y <= high; ++y) {
            for (int z = low; z <= high; ++z)
                visit(std::array<int, 3>{x, y, z});
        }
    }
}

glm::dvec3 vector(const std::array<int, 3>& v) {
    return {v[0], v[1], v[2]};
}

// Every symmetric view: faces edge-on, the farthest corner on a face, an edge, the nearest corner.
TEST(CellTemplate, CountsOfFigure1InEverySymmetricView) {
    std::array<std::array<int, 8>, 4> seen{};  // [visible faces][axes that lead]
    for_lattice(-3, 3, [&](const std::array<int, 3>& d) {
        if (d == std::array{0, 0, 0}) return;
        for_lattice(1, 3, [&](const std::array<int, 3>& h) {
            const Expected expected = figure_1(d, h);
            const CellTemplate shape = parallel_template(vector(d), vector(h));
            ASSERT_EQ(shape.visible_faces, expected.visible);
            ASSERT_EQ(shape.polygon_count, expected.polygons);
            ASSERT_EQ(shape.crossed_axes, expected.axes);
            ++seen[static_cast<std::size_t>(expected.visible)][expected.axes];
            ASSERT_NO_FATAL_FAILURE(expect_parallel(vector(d), vector(h)));
            // The same by cutting the faces with one another.
            ASSERT_EQ(
                overlaps(box(vector(h)), Plane(vector(d), std::nullopt), parallel_silhouette(vector(d), vector(h))),
                expected.polygons);
        });
    });
    for (unsigned axes = 1; axes < 8; ++axes) {
        EXPECT_GT(seen[3][axes], 0);  // seven positions over the nearest corner
        EXPECT_EQ(seen[2][axes] > 0, std::popcount(axes) < 3);
        EXPECT_EQ(seen[1][axes] > 0, std::popcount(axes) == 1);
    }
}

// Up to four units in the last place from x; 1e-16 of them from 0.
double beside(std::mt19937_64& random, double x) {
    const int n = std::uniform_int_distribution<int>(-4, 4)(random);
    if (x == 0) return n * 1e-16;
    for (int i = 0; i < std::abs(n); ++i)
        x = std::nextafter(x, n > 0 ? 1e300 : -1e300);
    return x;
}

// A few units in the last place beside every symmetric view: other classes, the same picture.
TEST(CellTemplate, BesideEverySymmetricView) {
    std::mt19937_64 random(201);
    std::array<int, 8> counts{};
    for_lattice(-2, 2, [&](const std::array<int, 3>& d) {
        if (d == std::array{0, 0, 0}) return;
        for_lattice(1, 3, [&](const std::array<int, 3>& h) {
            for (int trial = 0; trial < 3; ++trial) {
                glm::dvec3 direction = vector(d), edges = vector(h);
                for (int i = 0; i < 3; ++i) {
                    direction[i] = beside(random, direction[i]);
                    edges[i] = beside(random, edges[i]);
                }
                ASSERT_NO_FATAL_FAILURE(expect_parallel(direction, edges));
                ++counts[parallel_template(direction, edges).polygon_count];
            }
        });
    });
    for (const std::size_t polygons : {2U, 3U, 6U, 7U})
        EXPECT_GT(counts[polygons], 0);
}

TEST(CellTemplate, TenThousandRandomViewsAndShapes) {
    std::mt19937_64 random(202);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(-1, 1);
    std::array<int, 8> leading{};
    for (int trial = 0; trial < 10000; ++trial) {
        SCOPED_TRACE(trial);
        const double size = std::pow(10, 12 * unit(random)), length = std::pow(10, 6 * unit(random));
        const glm::dvec3 d = length * glm::dvec3(normal(random), normal(random), normal(random));
        const glm::dvec3 h =
            size * glm::dvec3(std::pow(10, unit(random)), std::pow(10, unit(random)), std::pow(10, unit(random)));
        ASSERT_NO_FATAL_FAILURE(expect_parallel(d, h));
        const CellTemplate shape = parallel_template(d, h);
        ASSERT_EQ(shape.polygon_count, 7U);
        ++leading[shape.crossed_axes];
    }
    for (const unsigned axis : {1U, 2U, 4U})
        EXPECT_GT(leading[axis], 2000);
}

// ---- Perspective ----

// Every interior pair lies on a ray of the eye with the template's ratio of depths; the cells between eye and back
// polygons, less those between eye and front polygons, have the cell's volume.
void expect_perspective(const glm::dvec3& eye, const Bounds& cell, const Plane& plane) {
    const CellTemplate shape = perspective_template(eye, cell);
    ASSERT_NO_FATAL_FAILURE(expect_tiles(shape, cell, plane, hull_area(cell, plane)));
    for (const TemplateVertex& v : shape.vertices()) {
        if (!v.interior) continue;
        const glm::dvec3 front = point_in(cell, v.front) - eye, back = point_in(cell, v.back) - eye;
        ASSERT_LT(glm::length(front - (1 - shape.interior_thickness) * back), 1e-14 * glm::length(back));
    }
    double volume = 0, cones = 0;
    for (const TemplatePolygon& p : shape.polygons()) {
        const auto cone = [&](std::size_t i, glm::dvec3 TemplateVertex::*end) {
            const auto at = [&](std::size_t n) { return point_in(cell, shape.vertices()[p.vertices[n]].*end) - eye; };
            return std::abs(det(at(0), at(i - 1), at(i))) / 6;
        };
        for (std::size_t i = 2; i < p.count; ++i) {
            volume += cone(i, &TemplateVertex::back) - cone(i, &TemplateVertex::front);
            cones += cone(i, &TemplateVertex::back);
        }
    }
    const glm::dvec3 h = cell.high - cell.low;
    // Differences of cones: rounding is relative to these; up to ten roundings each.
    ASSERT_NEAR(volume, h.x * h.y * h.z, 1e-13 * cones + 1e-14 * h.x * h.y * h.z);
}

// Edges of the boxes: 27 of them, or 8.
constexpr int longest_edge = CELLPROJ_SANITIZED ? 2 : 3;

TEST(CellTemplate, PerspectiveFromEveryLatticePoint) {
    std::array<std::array<int, 8>, 4> seen{};  // [visible faces][polygons]
    for_lattice(1, longest_edge, [&](const std::array<int, 3>& h) {
        const Bounds cell = box(vector(h));
        for_lattice(-4, 6, [&](const std::array<int, 3>& e) {
            const glm::dvec3 eye = vector(e);
            const CellTemplate shape = perspective_template(eye, cell);
            std::array<int, 3> near{};  // distances from the faces in front, 0 where none is
            int behind = 0;             // faces that the eye sees from inside, along axes that have none in front
            for (std::size_t i = 0; i < 3; ++i) {
                near[i] = std::max({-e[i], e[i] - h[i], 0});
                if (near[i] == 0) behind += (e[i] > 0 ? 1 : 0) + (e[i] < h[i] ? 1 : 0);
            }
            const Expected like_parallel = figure_1(near, h);  // g_i h_j against g_j h_i
            ASSERT_EQ(shape.visible_faces, like_parallel.visible);
            ASSERT_EQ(shape.crossed_axes, like_parallel.axes);
            const std::size_t strips =
                shape.visible_faces == 2 ? 2 : 1;  // an additional back face is cut by the edge in front
            ASSERT_EQ(shape.polygon_count, like_parallel.visible == 0
                                               ? 0
                                               : like_parallel.polygons + strips * static_cast<std::size_t>(behind));
            if (shape.visible_faces == 0) return;
            ++seen[static_cast<std::size_t>(shape.visible_faces)][shape.polygon_count];
            const Plane plane(eye - cell.center(), eye);
            for (unsigned c = 0; c < 8; ++c) {
                if (plane.depth_of(corner(cell, c)) < 0.2) return;  // beside or behind the eye: no picture on a plane
            }
            ASSERT_NO_FATAL_FAILURE(expect_perspective(eye, cell, plane));
            ASSERT_EQ(overlaps(cell, plane, hull_area(cell, plane)), shape.polygon_count);
        });
    });
    for (const std::size_t polygons : {3U, 4U, 5U})
        EXPECT_GT(seen[1][polygons], 0);
    for (const std::size_t polygons : {4U, 5U, 6U, 7U})
        EXPECT_GT(seen[2][polygons], 0);
    for (const std::size_t polygons : {6U, 7U})
        EXPECT_GT(seen[3][polygons], 0);
}

TEST(CellTemplate, PerspectiveBesideEveryLatticePoint) {
    std::mt19937_64 random(205);
    std::array<int, 8> counts{};
    for_lattice(1, longest_edge, [&](const std::array<int, 3>& h) {
        for_lattice(-4, 6, [&](const std::array<int, 3>& e) {
            glm::dvec3 eye = vector(e);
            Bounds cell = box(vector(h));
            for (int i = 0; i < 3; ++i) {
                eye[i] = beside(random, eye[i]);
                cell.low[i] = beside(random, cell.low[i]);
                cell.high[i] = beside(random, cell.high[i]);
            }
            const Plane plane(eye - cell.center(), eye);
            for (unsigned c = 0; c < 8; ++c) {
                if (plane.depth_of(corner(cell, c)) < 0.2) return;
            }
            ASSERT_NO_FATAL_FAILURE(expect_perspective(eye, cell, plane));
            ++counts[perspective_template(eye, cell).polygon_count];
        });
    });
    for (const std::size_t polygons : {3U, 4U, 5U, 6U, 7U})
        EXPECT_GT(counts[polygons], 0);
}

TEST(CellTemplate, PerspectiveOfTenThousandRandomCells) {
    std::mt19937_64 random(203);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::array<int, 4> seen{};
    int checked = 0;
    while (checked < 10000) {
        const double size = std::pow(10, 12 * unit(random));
        const glm::dvec3 h = glm::dvec3(std::pow(10, 0.5 * unit(random)), std::pow(10, 0.5 * unit(random)),
                                        std::pow(10, 0.5 * unit(random)));
        const Bounds cell{-0.5 * size * h, 0.5 * size * h};
        const glm::dvec3 eye = size * 5.0 * glm::dvec3(unit(random), unit(random), unit(random));
        if (perspective_template(eye, cell).visible_faces == 0) continue;
        const Plane plane(eye, eye);
        bool in_view = true;
        for (unsigned c = 0; c < 8; ++c)
            in_view = in_view && plane.depth_of(corner(cell, c)) > 0.1 * size;
        if (!in_view) continue;
        SCOPED_TRACE(checked++);
        ASSERT_NO_FATAL_FAILURE(expect_perspective(eye, cell, plane));
        ++seen[static_cast<std::size_t>(perspective_template(eye, cell).visible_faces)];
    }
    for (const std::size_t faces : {1U, 2U, 3U})
        EXPECT_GT(seen[faces], 100);
}

TEST(CellTemplate, NothingFromInsideTheCell) {
    for (const glm::dvec3& eye : {glm::dvec3(0.5), glm::dvec3(0), glm::dvec3(1, 0.5, 0), glm::dvec3(0.5, 1, 0.5)}) {
        const CellTemplate shape = perspective_template(eye, box({1, 1, 1}));
        EXPECT_EQ(shape.visible_faces, 0);
        EXPECT_EQ(shape.polygon_count, 0U);
    }
}

// From far away, the template of a perspective view is that of the parallel one.
TEST(CellTemplate, PerspectiveTendsToTheParallelView) {
    const glm::dvec3 h(1, 2, 1.5), d(0.3, 0.8, -0.5);
    const CellTemplate parallel = parallel_template(d, h), far = perspective_template(1e9 * glm::normalize(d), box(h));
    ASSERT_EQ(parallel.vertex_count, far.vertex_count);
    EXPECT_NEAR(far.interior_thickness * 1e9, parallel.interior_thickness, 1e-8);
    for (std::size_t v = 0; v < parallel.vertex_count; ++v) {
        EXPECT_LT(glm::length(parallel.vertices()[v].front - far.vertices()[v].front), 1e-8);
        EXPECT_LT(glm::length(parallel.vertices()[v].back - far.vertices()[v].back), 1e-8);
    }
}

// ---- On the screen ----

struct Segment {
    double enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
};

Segment cast(const Bounds& cell, const ScreenTransform::Ray& ray) {
    Segment s;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (cell.low[axis] - ray.origin[axis]) / ray.direction[axis];
        const double b = (cell.high[axis] - ray.origin[axis]) / ray.direction[axis];
        s.enter = std::max(s.enter, std::min(a, b));
        s.leave = std::min(s.leave, std::max(a, b));
    }
    return s;
}

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& center, bool perspective) {
    return {.projection = perspective ? Camera::Projection::perspective : Camera::Projection::parallel,
            .eye = eye,
            .center = center,
            .up = {0.1, 0.2, 1},
            .height = 4,
            .fov_y_degrees = 40};
}

CellTemplate template_for(const Camera& camera, const Bounds& cell) {
    const Eye eye = camera.viewpoint();
    return eye.at_infinity ? parallel_template(eye.xyz, cell.high - cell.low) : perspective_template(eye.xyz, cell);
}

class TemplateOnTheScreen : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(ParallelAndPerspective, TemplateOnTheScreen, testing::Bool());

// The terms, interpolated linearly over the polygons, are those of the ray through the pixel; a linear field comes out
// exactly.
TEST_P(TemplateOnTheScreen, InterpolatedTermsAreTheSegmentOfTheRay) {
    const bool perspective = GetParam();
    std::mt19937_64 random(204);
    std::uniform_real_distribution<double> unit(-1, 1);
    int checked = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        SCOPED_TRACE(trial);
        const glm::dvec3 place(unit(random), unit(random), unit(random)),
            slope(unit(random), unit(random), unit(random));
        const Bounds cell{place, place + 0.6 + 0.4 * glm::dvec3(unit(random), unit(random), unit(random))};
        const Camera camera = camera_at(cell.center() + 2.5 * glm::dvec3(unit(random), unit(random), unit(random)),
                                        cell.center(), perspective);
        const ScreenTransform transform(camera, {300, 200});
        bool in_view = true;
        std::array<double, 8> scalars{};
        for (unsigned c = 0; c < 8; ++c) {
            in_view = in_view && (!perspective || transform.to_eye(corner(cell, c)).z > 0.1);
            scalars[c] = 0.3 + glm::dot(slope, corner(cell, c));
        }
        const CellTemplate shape = template_for(camera, cell);
        if (!in_view || shape.visible_faces == 0) continue;
        for (const TemplatePolygon& polygon : shape.polygons()) {
            // The mean of the corners with random weights, half the time; near one of them or an edge else.
            std::array<double, 4> weights{};
            double sum = 0;
            for (std::size_t i = 0; i < polygon.count; ++i)
                sum += weights[i] = std::pow(0.5 + 0.499 * unit(random), trial % 2 == 0 ? 1 : 4);
            ProjectedVertex v{{0, 0}, 0, 0, 0, 0};
            double size = 0;
            Polygon outline;
            for (std::size_t i = 0; i < polygon.count; ++i) {
                const ProjectedVertex p =
                    project(shape.vertices()[polygon.vertices[i]], shape, cell, scalars, transform);
                const double w = weights[i] / sum;
                v.position += w * p.position;
                v.front_depth += w * p.front_depth;
                v.thickness += w * p.thickness;
                v.front_scalar += w * p.front_scalar;
                v.back_scalar += w * p.back_scalar;
                outline.push_back(p.position);
            }
            size = std::abs(area(outline));
            if (size < 1) continue;  // less than a pixel: the ray through a rounded point may miss it
            const auto found = testing_support::segment_of(v, perspective);
            const ScreenTransform::Ray ray = transform.ray(v.position);
            const double stretch = perspective ? 1 / transform.to_eye(ray.origin + ray.direction).z : 1;  // of a ray against its depth
            const Segment segment = cast(cell, ray);
            const auto scalar = [&](double t) { return 0.3 + glm::dot(slope, ray.origin + t * ray.direction); };
            // 1e-10: the rounding of pixels (3e-14) over the slope of faces seen up to a thousandth off edge-on.
            ASSERT_NEAR(found.front, transform.to_eye(ray.origin + segment.enter * ray.direction).z, 1e-10);
            ASSERT_NEAR((found.back - found.front) * stretch, segment.leave - segment.enter, 1e-10);
            ASSERT_NEAR(found.s_front, scalar(segment.enter), 1e-10);
            ASSERT_NEAR(found.s_back, scalar(segment.leave), 1e-10);
            ++checked;
        }
    }
    EXPECT_GT(checked, 5000);
}

// Cells that share a face share its corners on the screen to the last bit: no gaps, no overlaps.
TEST_P(TemplateOnTheScreen, NeighboursMeet) {
    const bool perspective = GetParam();
    const Grid grid{{uniform_axis(0.1, 0.1, 5), uniform_axis(-0.3, 0.1, 5), uniform_axis(1e6, 0.3, 5)},
                    FieldLocation::cells,
                    std::vector<double>(64),
                    {}};
    const Camera camera =
        camera_at(grid.bounds().center() + glm::dvec3(1.3, -2, 1.9), grid.bounds().center(), perspective);
    const ScreenTransform transform(camera, {300, 200});
    std::vector<std::optional<glm::dvec2>> place(125);
    int shared = 0;
    for_lattice(0, 3, [&](const std::array<int, 3>& c) {
        const GridCell id{static_cast<std::size_t>(c[0]), static_cast<std::size_t>(c[1]),
                          static_cast<std::size_t>(c[2])};
        const Bounds cell = grid.cell_bounds(id);
        const CellTemplate shape = perspective ? perspective_template(camera.eye, cell)
                                               : parallel_template(camera.viewpoint().xyz, grid.cell_edges(id));
        ASSERT_GT(shape.polygon_count, 0U);
        for (const TemplateVertex& v : shape.vertices()) {
            if (v.interior) continue;
            const std::size_t point =
                id[0] + static_cast<std::size_t>(v.front.x) +
                5 * (id[1] + static_cast<std::size_t>(v.front.y) + 5 * (id[2] + static_cast<std::size_t>(v.front.z)));
            const glm::dvec2 position = project(v, shape, cell, {}, transform).position;
            if (place[point]) {
                ASSERT_EQ(*place[point], position);
                ++shared;
            }
            place[point] = position;
        }
    });
    EXPECT_GT(shared, 200);
}

// At the vertices themselves any trilinear field comes out exactly: linear on edges, bilinear on faces.
TEST(CellTemplate, ScalarsOfPairsAreTrilinear) {
    const std::array<double, 8> scalars{1, -2, 3, 5, -8, 13, 2, 1};
    const Bounds cell = box({1, 2, 3});
    for (const bool perspective : {false, true}) {
        const Camera camera = camera_at({3, -2, 5}, cell.center(), perspective);
        const ScreenTransform transform(camera, {300, 200});
        const CellTemplate shape = template_for(camera, cell);
        ASSERT_EQ(shape.polygon_count, 7U);
        for (const TemplateVertex& v : shape.vertices()) {
            const ProjectedVertex p = project(v, shape, cell, scalars, transform);
            const double depth = perspective ? p.front_depth : 1, back = perspective ? p.front_depth - p.thickness : 1;
            EXPECT_NEAR(p.front_scalar / depth, interpolate(scalars, v.front), 1e-14);
            EXPECT_NEAR(p.back_scalar / back, interpolate(scalars, v.back), 1e-13);
        }
    }
}

}  // namespace
}  // namespace cellproj
