// SPDX-License-Identifier: BSD-3-Clause
//
// TetGen's .poly and .smesh files to surfaces, and facets of several polygons to triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "mesh/io/planar_facet.hpp"
#include "mesh/surface.hpp"
#include "tests/surface_fixtures.hpp"

namespace cellproj {
namespace read_poly_test {

namespace fs = std::filesystem;
using mesher_fixtures::error_of;
using Triangles = std::vector<std::array<VertexId, 3>>;

// ---- Facets ----

struct Facet {
    std::vector<glm::dvec3> points;
    std::vector<std::vector<VertexId>> loops;
    std::vector<glm::dvec3> holes;

    void add_loop(const std::vector<glm::dvec3>& corners) {
        auto& loop = loops.emplace_back();
        for (const glm::dvec3& p : corners) {
            loop.push_back(static_cast<VertexId>(points.size()));
            points.push_back(p);
        }
    }
    void add_square(double x, double y, double size) {
        add_loop({{x, y, 0}, {x + size, y, 0}, {x + size, y + size, 0}, {x, y + size, 0}});
    }
};

double area(const Facet& facet, const Triangles& triangles) {
    double sum = 0.0;
    for (const auto& t : triangles)
        sum += 0.5 * glm::length(glm::cross(facet.points[t[1]] - facet.points[t[0]], facet.points[t[2]] - facet.points[t[0]]));
    return sum;
}

// The area, and that the boundary of the triangles is made of whole edges of the polygons: nothing overlaps or hangs.
void expect_covers(const Facet& facet, double expected, double tolerance = 0.0) {
    const auto triangles = triangulate_facet(facet.points, facet.loops, facet.holes);
    ASSERT_TRUE(triangles);
    EXPECT_NEAR(area(facet, *triangles), expected, tolerance);
    std::map<std::pair<VertexId, VertexId>, int> uses;
    for (const auto& t : *triangles) {
        for (std::size_t i = 0; i < 3; ++i)
            ++uses[{t[i], t[(i + 1) % 3]}];
    }
    std::map<std::pair<VertexId, VertexId>, int> edges;
    for (const auto& loop : facet.loops) {
        for (std::size_t i = 0; i < loop.size(); ++i)
            ++edges[std::minmax(loop[i], loop[(i + 1) % loop.size()])];
    }
    for (const auto& [edge, count] : uses) {
        EXPECT_EQ(count, 1);
        const bool on_boundary = uses.count({edge.second, edge.first}) == 0;
        if (on_boundary) {
            EXPECT_EQ(edges.count(std::minmax(edge.first, edge.second)), 1U);
        }
    }
}

TEST(PlanarFacet, HolesAreLeftOut) {
    Facet facet;
    facet.add_square(0, 0, 4);
    facet.add_square(1, 1, 1);
    facet.holes = {{1.5, 1.5, 0}};
    expect_covers(facet, 16 - 1);
    facet.add_square(2.5, 2.5, 1);  // another one, without a seed: its edges stay
    expect_covers(facet, 16 - 1);
    facet.holes.push_back({3, 3, 0});
    expect_covers(facet, 16 - 2);
}

TEST(PlanarFacet, PolygonsNestAndLieSideBySide) {
    Facet facet;
    facet.add_square(0, 0, 8);
    facet.add_square(1, 1, 6);
    facet.add_square(2, 2, 4);
    facet.add_square(10, 0, 2);
    expect_covers(facet, 64 + 4);
    facet.holes = {{1.5, 4, 0}};  // between the second and the third
    expect_covers(facet, 64 - 36 + 16 + 4);
    facet.holes = {{0.5, 4, 0}};
    expect_covers(facet, 36 + 4);
}

TEST(PlanarFacet, VerticesWithinEdgesAreKept) {
    Facet facet;
    facet.add_loop({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 3, 0}, {1, 3, 0}, {0, 3, 0}, {0, 2, 0}});
    facet.add_square(1, 1, 1);
    facet.holes = {{1.5, 1.5, 0}};
    const auto triangles = triangulate_facet(facet.points, facet.loops, facet.holes);
    ASSERT_TRUE(triangles);
    std::vector<bool> used(facet.points.size());
    for (const auto& t : *triangles) {
        for (const VertexId v : t)
            used[v] = true;
    }
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
    expect_covers(facet, 9 - 1);
}

TEST(PlanarFacet, PolygonsMayShareCornersAndEdges) {
    Facet facet;
    facet.points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {4, 0, 0}, {4, 2, 0}, {1, 1, 0}, {1, 0.5, 0}};
    facet.loops = {{0, 1, 2, 3}, {1, 4, 5, 2}};
    expect_covers(facet, 8);
    facet.loops = {{0, 1, 2, 3}, {0, 7, 6}};  // a triangle that hangs at a corner
    facet.holes = {{0.9, 0.7, 0}};
    expect_covers(facet, 4 - 0.25);
}

TEST(PlanarFacet, WhatHasNoAreaOrCrossesIsRefused) {
    Facet facet;
    facet.add_loop({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
    EXPECT_FALSE(triangulate_facet(facet.points, facet.loops, {}));
    Facet bow;
    bow.add_loop({{0, 0, 0}, {2, 1, 0}, {2, 0, 0}, {0, 1, 0}});
    bow.add_square(5, 5, 1);
    EXPECT_FALSE(triangulate_facet(bow.points, bow.loops, {}));
}

// Stars with star-shaped holes, in planes of any position; areas by the shoelace formula.
TEST(PlanarFacet, RandomStarsKeepTheirArea) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int trial = 0; trial < 200; ++trial) {
        const glm::dvec3 a = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)) - 0.4);
        const glm::dvec3 u = glm::normalize(glm::cross(a, glm::dvec3(0.3, -0.5, 0.8))), v = glm::cross(a, u);
        const glm::dvec3 origin = (trial % 2 == 0 ? 0.0 : 1e6) * glm::dvec3(1, -2, 3);
        Facet facet;
        double expected = 0.0;
        const auto add_star = [&](const glm::dvec2& center, double radius, int corners, double sign) {
            std::vector<glm::dvec3> loop;
            std::vector<glm::dvec2> flat;
            for (int i = 0; i < corners; ++i) {
                const double angle = 2.0 * std::numbers::pi * i / corners, r = radius * (0.3 + 0.7 * unit(random));
                flat.push_back(center + r * glm::dvec2(std::cos(angle), std::sin(angle)));
                loop.push_back(origin + flat.back().x * u + flat.back().y * v);
            }
            for (std::size_t i = 0; i < flat.size(); ++i) {
                const glm::dvec2 p = flat[i], q = flat[(i + 1) % flat.size()];
                expected += sign * 0.5 * (p.x * q.y - p.y * q.x);
            }
            if (unit(random) < 0.5) std::reverse(loop.begin(), loop.end());
            facet.add_loop(loop);
        };
        add_star({0, 0}, 10.0, 40, 1.0);
        // Within the smallest circle that every star of radius 10 contains.
        for (const glm::dvec2 center : {glm::dvec2(1, 1), glm::dvec2(-1, 1), glm::dvec2(0, -1)}) {
            add_star(center, 0.7, 3 + trial % 9, -1.0);
            facet.holes.push_back(origin + center.x * u + center.y * v);
        }
        // Coordinates of 1e6 are rounded to 1e-10; some hundred edges of length up to 20.
        expect_covers(facet, expected, trial % 2 == 0 ? 1e-12 * 400 : 1e-10 * 400);
        ASSERT_FALSE(HasFailure()) << "trial " << trial;
    }
}

// ---- Files ----

class PolyFile : public SurfaceFile {
protected:
    void expect_refused(const std::string& bytes, const std::string& words) const {
        SurfaceFile::expect_refused("a.poly", bytes, words);
    }
};

// A cube, its lid pierced by a square; one attribute and a marker at each point. Indices start at `first`.
std::string points(int first) {
    const std::array<std::array<double, 2>, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    std::string text = "12 3 1 1 # points\n";
    int index = first;
    const auto add = [&](double x, double y, double z) {
        text += std::to_string(index++) + " " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + " " +
                std::to_string(10.0 * z) + " 7\n";
    };
    for (const double z : {0.0, 1.0}) {
        for (const auto& p : square)
            add(p[0], p[1], z);
    }
    for (const auto& p : square)
        add(0.25 + 0.5 * p[0], 0.25 + 0.5 * p[1], 1.0);
    return text;
}

std::string corners(std::initializer_list<int> ids, int first) {
    std::string text = std::to_string(ids.size());
    for (const int id : ids)
        text.append(" ").append(std::to_string(id + first));
    return text + "\n";
}

std::string facets(int first) {
    std::string text = "\n6 1\n";
    for (const auto& ids : {std::initializer_list<int>{0, 1, 2, 3}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}})
        text += "1 0 3\n" + corners(ids, first);
    return text + "2 1 # the lid\n" + corners({4, 5, 6, 7}, first) + corners({8, 9, 10, 11}, first) + "1 0.5 0.5 1\n";
}

constexpr const char* seeds = "1\n1 0.5 0.5 0.5\n2\n1 .1 .1 .1 10 0.5\n2 .9 .9 .9 -20 # no bound\n";

TEST_F(PolyFile, FacetsHolesRegionsAndAttributesAreRead) {
    for (const int first : {0, 1}) {
        const Surface surface = read_surface(write("a.poly", points(first) + facets(first) + seeds));
        EXPECT_EQ(surface.points.size(), 12U);
        EXPECT_EQ(surface.points[10], glm::dvec3(0.75, 0.75, 1));
        ASSERT_EQ(surface.polygons.size(), 5U + 8U);  // an annulus of 8 vertices has 8 triangles
        EXPECT_EQ(surface.polygons[1], (std::vector<VertexId>{0, 1, 5, 4}));
        EXPECT_EQ(facet_of(surface, 4), 4U);
        EXPECT_EQ(facet_of(surface, 5), 5U);
        EXPECT_EQ(facet_of(surface, 12), 5U);
        EXPECT_EQ(surface.inside, Inside::enclosed);
        EXPECT_EQ(surface.holes, (std::vector<glm::dvec3>{{0.5, 0.5, 0.5}}));
        ASSERT_EQ(surface.regions.size(), 2U);
        EXPECT_EQ(surface.regions[0].attribute, 10);
        EXPECT_EQ(surface.regions[0].max_volume, 0.5);
        EXPECT_EQ(surface.regions[1].attribute, -20);
        EXPECT_EQ(surface.regions[1].max_volume, 0);
        ASSERT_EQ(surface.point_fields.size(), 1U);
        EXPECT_EQ(surface.point_fields[0].name, "attribute_1");
        EXPECT_EQ(surface.point_fields[0].values[4], 10.0);
    }
}

TEST_F(PolyFile, PointsMayStandInTheNodeFile) {
    write("a.node", points(1));
    const Surface inside = read_surface(write("b.poly", points(1) + facets(1) + "0\n"));
    const Surface beside = read_surface(write("a.poly", "0 3 1 1" + facets(1) + "0\n0\n"));
    EXPECT_EQ(beside.points, inside.points);
    EXPECT_EQ(beside.polygons, inside.polygons);
    EXPECT_NE(std::string(error_of([&] { read_surface(write("c.poly", std::string("0").append(facets(1)))); }).what()).find("c.node"),
              std::string::npos);
}

TEST_F(PolyFile, SmeshHasOnePolygonPerLine) {
    const std::string lines = "\n2 1\n4 1 2 3 4 -1\n3 5 6\n7 # of two lines\n0\n";
    const Surface surface = read_surface(write("a.smesh", points(1) + lines));
    EXPECT_EQ(surface.polygons, (std::vector<std::vector<VertexId>>{{0, 1, 2, 3}, {4, 5, 6}}));
}

TEST_F(PolyFile, BrokenFilesAreRefusedByLine) {
    expect_refused("4 2 0 0\n1 0 0\n2 1 0\n3 1 1\n4 0 1\n0 0\n0\n", "line 1: expected the dimension 3");
    expect_refused(points(1) + "\n1 0\n1\n2 1 2\n0\n", "points and segments within a facet are not supported");
    expect_refused(points(1) + "\n1 0\n1\n3 1 2 13\n0\n", "line 17: expected a point from 1 to 12, found \"13\"");
    expect_refused(points(1) + "\n1 0\n0\n0\n", "at least one polygon of a facet");
    expect_refused(points(1) + "\n1 0\n2 0\n4 1 2 3 4\n4 1 3 2 4\n0\n", "facet 0, whose polygons do");
    expect_refused(points(1) + "\n99999999999 0\n", "the number of facets that fits the rest of the file");
    expect_refused(points(1) + facets(1) + "1\n1 0.5 nan 0.5\n", "finite");
    expect_refused("hello\n", "the number of points");
}

TEST_F(PolyFile, CutFilesDoNoHarm) {
    const std::string bytes = points(1) + facets(1) + seeds;
    std::size_t refused = 0;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const fs::path file = write("a.poly", bytes.substr(0, size));
        try {
            read_surface(file);
        } catch (const Error& error) {
            ++refused;
            EXPECT_NE(error.place().find((folder_ / "a.").string()), std::string::npos) << error.what();
        }
    }
    // The list of regions may be missing, and figures at the very end cannot be known to be.
    EXPECT_GT(refused, bytes.size() - 40);
}

// SOURCES.md: 28 points; the file itself has 23 facets, the third of them with a facet hole, two holes and two regions.
TEST_F(PolyFile, ExampleOfTetgen) {
    const fs::path file = fs::path(CELLPROJ_SHARED_DATA) / "tetgen/example.poly";
    if (!fs::exists(file)) GTEST_SKIP() << "no ../shared/data/tetgen";
    const Surface surface = read_surface(file);
    EXPECT_EQ(surface.points.size(), 28U);
    EXPECT_EQ(surface.facets.back(), 22U);
    EXPECT_EQ(surface.holes.size(), 2U);
    EXPECT_EQ(surface.regions.size(), 2U);
    EXPECT_TRUE(surface.point_fields.empty());
}

}  // namespace
}  // namespace cellproj
