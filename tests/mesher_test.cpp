// SPDX-License-Identifier: BSD-3-Clause
//
// The caller's side of the mesher against the real program: volumes that are known exactly, bounds that every cell must
// keep, and the ways a request can be refused. (What a broken mesher does to its caller: mesher_failure_test.cpp.)
#include "mesh/mesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/child_process.hpp"
#include "mesh/error.hpp"
#include "mesh/mesher_format.hpp"
#include "mesh/predicates.hpp"
#include "tests/mesher_fixtures.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace mesher_test {

using mesher_fixtures::add_box;
using mesher_fixtures::error_of;
using mesher_fixtures::unit_cube;
using testing_support::total_volume;

MesherOptions real_mesher() {
    MesherOptions options;
    options.program = CELLPROJ_MESHER_PROGRAM;
    return options;
}

// Divergence theorem, over facets fanned from their first vertex.
double enclosed_volume(const std::vector<glm::dvec3>& points, const std::vector<std::vector<VertexId>>& facets) {
    double sum = 0.0;
    for (const std::vector<VertexId>& f : facets) {
        for (std::size_t i = 2; i < f.size(); ++i) {
            sum += glm::dot(points[f[0]], glm::cross(points[f[i - 1]], points[f[i]])) / 6.0;
        }
    }
    return std::abs(sum);
}

void expect_all_positive(const TetMesh& mesh) {
    for (const auto& t : mesh.tets) {
        ASSERT_EQ(orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]), 1);
    }
}

// A latitude-longitude sphere: triangles at the poles, planar trapezoids between them.
struct Sphere {
    std::vector<glm::dvec3> points;
    std::vector<std::vector<VertexId>> facets;
};

Sphere make_sphere(const glm::dvec3& center, double radius, unsigned rings, unsigned sectors) {
    Sphere sphere;
    const double pi = std::acos(-1.0);
    sphere.points = {center + glm::dvec3(0, 0, radius), center - glm::dvec3(0, 0, radius)};
    for (unsigned r = 1; r < rings; ++r) {
        for (unsigned s = 0; s < sectors; ++s) {
            const double theta = pi * r / rings, phi = 2.0 * pi * s / sectors;
            sphere.points.push_back(center + radius * glm::dvec3(std::sin(theta) * std::cos(phi),
                                                                 std::sin(theta) * std::sin(phi), std::cos(theta)));
        }
    }
    const auto at = [&](unsigned r, unsigned s) { return VertexId{2 + (r - 1) * sectors + s % sectors}; };
    for (unsigned s = 0; s < sectors; ++s) {
        sphere.facets.push_back({0, at(1, s), at(1, s + 1)});
        sphere.facets.push_back({1, at(rings - 1, s + 1), at(rings - 1, s)});
        for (unsigned r = 1; r + 1 < rings; ++r) {
            // Two triangles: a trapezoid would be planar up to rounding only.
            sphere.facets.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
            sphere.facets.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
        }
    }
    return sphere;
}

TEST(Mesher, UnitCubeHasVolumeOne) {
    const TetMesh mesh = tetrahedralize(unit_cube(), real_mesher());
    EXPECT_GE(mesh.tets.size(), 5U);        // no cube falls into fewer
    EXPECT_NEAR(total_volume(mesh), 1.0, 1e-12);  // a handful of cells, each within a few ulp
    EXPECT_TRUE(mesh.cell_fields.empty());
    expect_all_positive(mesh);
}

TEST(Mesher, TheSameComplexGivesTheSameMesh) {
    MesherOptions options = real_mesher();
    options.max_volume = 0.01;
    const TetMesh a = tetrahedralize(unit_cube(), options), b = tetrahedralize(unit_cube(), options);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.tets, b.tets);
}

TEST(Mesher, HoleIsLeftEmpty) {
    PiecewiseLinearComplex complex;
    add_box(complex, {-2, -2, -2}, {2, 2, 2});
    const Sphere sphere = make_sphere({0.1, 0.2, 0.3}, 1.0, 8, 12);
    const auto first = static_cast<VertexId>(complex.points.size());
    complex.points.insert(complex.points.end(), sphere.points.begin(), sphere.points.end());
    for (std::vector<VertexId> facet : sphere.facets) {
        for (VertexId& v : facet)
            v += first;
        complex.facets.push_back(facet);
    }
    const double ball = enclosed_volume(sphere.points, sphere.facets);
    ASSERT_GT(ball, 3.5);  // the fixture itself: below 4π/3 ≈ 4.19, above 80 % of it

    // Some hundred cells, each within a few ulp of 64: 1e-12 of the whole leaves a factor of ten.
    EXPECT_NEAR(total_volume(tetrahedralize(complex, real_mesher())), 64.0, 64e-12);
    complex.holes = {{0.1, 0.2, 0.3}};
    const TetMesh mesh = tetrahedralize(complex, real_mesher());
    EXPECT_NEAR(total_volume(mesh), 64.0 - ball, 64e-12);
    expect_all_positive(mesh);
}

TEST(Mesher, PointsWithoutFacetsBecomeVertices) {
    PiecewiseLinearComplex complex = unit_cube();
    const glm::dvec3 inside(0.3, 0.4, 0.6);
    complex.points.push_back(inside);
    const TetMesh mesh = tetrahedralize(complex, real_mesher());
    const auto found = std::find(mesh.points.begin(), mesh.points.end(), inside);
    ASSERT_NE(found, mesh.points.end());
    const auto id = static_cast<VertexId>(found - mesh.points.begin());
    EXPECT_TRUE(std::any_of(mesh.tets.begin(), mesh.tets.end(),
                            [&](const auto& t) { return std::find(t.begin(), t.end(), id) != t.end(); }));
}

// Two boxes of volume 1 and 2 that share the square x = 1.
PiecewiseLinearComplex two_rooms() {
    PiecewiseLinearComplex complex;
    add_box(complex, {0, 0, 0}, {1, 1, 1});
    for (const double x : {3.0}) {
        for (const glm::dvec3& p : {glm::dvec3(x, 0, 0), {x, 1, 0}, {x, 0, 1}, {x, 1, 1}})
            complex.points.push_back(p);
    }
    // add_box numbers its corners by bits: x 1, y 2, z 4. So x = 1 holds 1, 3, 5, 7; x = 3 holds 8, 9, 10, 11.
    complex.facets.insert(complex.facets.end(),
                          {{8, 9, 11, 10}, {1, 8, 9, 3}, {5, 10, 11, 7}, {1, 8, 10, 5}, {3, 9, 11, 7}});
    complex.regions = {{{0.5, 0.5, 0.5}, 10.0, 0.0}, {{2.0, 0.5, 0.5}, 20.0, 0.0}};
    return complex;
}

TEST(Mesher, RegionsKeepTheirVolumes) {
    const TetMesh mesh = tetrahedralize(two_rooms(), real_mesher());
    ASSERT_EQ(mesh.cell_fields.size(), 1U);
    const Field& region = mesh.cell_fields.front();
    EXPECT_EQ(region.name, "region");
    ASSERT_EQ(region.values.size(), mesh.tets.size());
    double first = 0.0, second = 0.0;
    for (CellId c = 0; c < mesh.tets.size(); ++c) {
        ASSERT_TRUE(region.values[c] == 10.0 || region.values[c] == 20.0) << region.values[c];
        (region.values[c] == 10.0 ? first : second) += signed_volume(mesh, c);
    }
    EXPECT_NEAR(first, 1.0, 1e-12);
    EXPECT_NEAR(second, 2.0, 1e-12);
}

// TetGen compares its own float64 volume with the bound; ours sums the same products in another order, a few ulp of the
// determinant's largest product (≤ 1) away: 1e-15 absolute.
constexpr double volume_slack = 1e-15;

TEST(Mesher, EveryCellKeepsTheVolumeBound) {
    MesherOptions options = real_mesher();
    options.max_volume = 1e-3;
    const TetMesh mesh = tetrahedralize(unit_cube(), options);
    for (CellId c = 0; c < mesh.tets.size(); ++c)
        ASSERT_LE(signed_volume(mesh, c), 1e-3 + volume_slack);
    EXPECT_GE(mesh.tets.size(), 1000U);
    EXPECT_NEAR(total_volume(mesh), 1.0, 1e-12);
}

TEST(Mesher, EveryRegionKeepsItsOwnBound) {
    PiecewiseLinearComplex complex = two_rooms();
    complex.regions[0].max_volume = 2e-3;
    MesherOptions options = real_mesher();
    options.max_volume = 5e-2;
    const TetMesh mesh = tetrahedralize(complex, options);
    double largest_in_second = 0.0;
    for (CellId c = 0; c < mesh.tets.size(); ++c) {
        const double v = signed_volume(mesh, c);
        if (mesh.cell_fields[0].values[c] == 10.0) {
            ASSERT_LE(v, 2e-3 + volume_slack);
        } else {
            largest_in_second = std::max(largest_in_second, v);
        }
    }
    EXPECT_LE(largest_in_second, 5e-2 + volume_slack);
    EXPECT_GT(largest_in_second, 2e-3);  // the fine bound is the first region's alone
}

double radius_edge_ratio(const TetMesh& mesh, CellId c) {
    const auto& t = mesh.tets[c];
    const glm::dvec3 a = mesh.points[t[0]];
    const glm::dvec3 u = mesh.points[t[1]] - a, v = mesh.points[t[2]] - a, w = mesh.points[t[3]] - a;
    const glm::dvec3 circumcenter =
        (glm::dot(u, u) * glm::cross(v, w) + glm::dot(v, v) * glm::cross(w, u) + glm::dot(w, w) * glm::cross(u, v)) /
        (2.0 * glm::dot(u, glm::cross(v, w)));
    const double shortest = std::min(
        {glm::length(u), glm::length(v), glm::length(w), glm::length(u - v), glm::length(v - w), glm::length(w - u)});
    return glm::length(circumcenter) / shortest;
}

double worst_ratio(const TetMesh& mesh) {
    double worst = 0.0;
    for (CellId c = 0; c < mesh.tets.size(); ++c)
        worst = std::max(worst, radius_edge_ratio(mesh, c));
    return worst;
}

TEST(Mesher, QualityBoundsTheRadiusEdgeRatio) {
    // Two points a hundredth apart in a cube: without refinement, cells with one very short edge.
    PiecewiseLinearComplex complex = unit_cube();
    complex.points.insert(complex.points.end(), {{0.5, 0.5, 0.5}, {0.51, 0.5, 0.5}});
    MesherOptions options = real_mesher();
    EXPECT_GT(worst_ratio(tetrahedralize(complex, options)), 10.0);
    options.radius_edge_ratio = 1.5;
    const TetMesh mesh = tetrahedralize(complex, options);
    // All angles of the input are right ones, for which Delaunay refinement keeps its bound (Shewchuk 1998); the slack
    // is the rounding of the circumcentre.
    EXPECT_LE(worst_ratio(mesh), 1.5 + 1e-9);
    EXPECT_NEAR(total_volume(mesh), 1.0, 1e-12);
}

TEST(Mesher, RefusesBadComplexes) {
    const auto kind_and_words = [](const PiecewiseLinearComplex& complex, const std::string& words) {
        const Error error = error_of([&] { tetrahedralize(complex, real_mesher()); });
        EXPECT_EQ(error.kind(), ErrorKind::data) << error.what();
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();

    PiecewiseLinearComplex complex = unit_cube();
    complex.points.resize(3);
    complex.facets = {{0, 1, 2}};
    kind_and_words(complex, "found 3 points");

    complex = unit_cube();
    complex.facets[2][1] = 8;
    kind_and_words(complex, "facet 2 with id 8");

    complex = unit_cube();
    complex.facets[4].resize(2);
    kind_and_words(complex, "facet 4 with 2");

    complex = unit_cube();
    complex.points[5].y = nan;
    kind_and_words(complex, "point 5 is not finite");

    complex = unit_cube();
    complex.holes = {{0.5, inf, 0.5}};
    kind_and_words(complex, "hole 0 is not finite");

    complex = unit_cube();
    complex.regions = {{{0.5, 0.5, 0.5}, nan, 0.0}};
    kind_and_words(complex, "region 0 is not finite");
}

TEST(Mesher, RefusesBadOptions) {
    const auto expect_option_error = [](const MesherOptions& options, const std::string& name) {
        const Error error = error_of([&] { tetrahedralize(unit_cube(), options); });
        EXPECT_EQ(error.kind(), ErrorKind::option) << error.what();
        EXPECT_NE(error.place().find(name), std::string::npos) << error.what();
    };
    MesherOptions options = real_mesher();
    options.max_volume = -1.0;
    expect_option_error(options, "max_volume");
    options = real_mesher();
    options.radius_edge_ratio = std::numeric_limits<double>::quiet_NaN();
    expect_option_error(options, "radius_edge_ratio");
    options = real_mesher();
    options.timeout_seconds = 0.0;
    expect_option_error(options, "timeout_seconds");
}

Error mesher_error(const PiecewiseLinearComplex& complex) {
    Error error = error_of([&] { tetrahedralize(complex, real_mesher()); });
    EXPECT_EQ(error.kind(), ErrorKind::mesher) << error.what();
    return error;
}

TEST(Mesher, OpenSurfaceEnclosesNothing) {
    PiecewiseLinearComplex complex = unit_cube();
    complex.facets.pop_back();
    EXPECT_NE(std::string(mesher_error(complex).what()).find("no cells"), std::string::npos);
}

TEST(Mesher, SelfIntersectionIsToldInWords) {
    PiecewiseLinearComplex complex;  // TetGen's throw, which would crash it while unwinding, arrives as words
    add_box(complex, {0, 0, 0}, {1, 1, 1});
    add_box(complex, {0.5, 0.5, 0.5}, {1.5, 1.5, 1.5});
    const Error error = mesher_error(complex);
    EXPECT_NE(error.found().find("intersects itself"), std::string::npos) << error.what();

    const TetMesh alive = tetrahedralize(unit_cube(), real_mesher());  // and nothing lingers from the failure
    EXPECT_NEAR(total_volume(alive), 1.0, 1e-12);
}

TEST(Mesher, CoplanarPointsAreAnError) {
    PiecewiseLinearComplex complex;
    complex.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    complex.facets = {{0, 1, 2, 3}};
    mesher_error(complex);
}

TEST(Mesher, NoFacetsAreAnError) {
    PiecewiseLinearComplex complex = unit_cube();
    complex.facets.clear();
    mesher_error(complex);
}

// The program does not trust its callers. It says in one line what is wrong with a request, and prints nothing else.
void expect_refusal(const std::string& request, const std::string& words) {
    const ChildResult result =
        run_child(CELLPROJ_MESHER_PROGRAM, request, 60.0, [](std::string_view) { return false; });
    EXPECT_EQ(result.end, ChildResult::End::exited);
    EXPECT_EQ(result.code, 1);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.messages.find(words), std::string::npos) << result.messages;
    EXPECT_EQ(result.messages.find('\n'), result.messages.size() - 1) << result.messages;
}

TEST(MesherProgram, ChecksItsInput) {
    expect_refusal("", "expected a message that starts with");
    expect_refusal("# a .poly file", "expected a message that starts with");
    expect_refusal(encode_request(unit_cube(), -1.0, 0.0), "max_volume");
    expect_refusal(encode_request(unit_cube(), 0.0, std::numeric_limits<double>::infinity()), "radius_edge_ratio");
    PiecewiseLinearComplex complex = unit_cube();
    complex.facets[0][0] = 99;
    expect_refusal(encode_request(complex, 0.0, 0.0), "facet 0 with id 99");
    complex = unit_cube();
    complex.points[7].x = std::numeric_limits<double>::quiet_NaN();
    expect_refusal(encode_request(complex, 0.0, 0.0), "point 7 is not finite");
}

TEST(MesherProgram, AnswersAndNothingElse) {
    const ChildResult result = run_child(CELLPROJ_MESHER_PROGRAM, encode_request(unit_cube(), 0.01, 1.5), 60.0,
                                         [](std::string_view) { return false; });
    EXPECT_EQ(result.code, 0);
    EXPECT_EQ(result.messages, "");
    // The format leaves the orientation of cells to `tetrahedralize`.
    EXPECT_NEAR(std::abs(total_volume(decode_answer(result.output, "answer"))), 1.0, 1e-12);
}

}  // namespace
}  // namespace cellproj
