// SPDX-License-Identifier: BSD-3-Clause
//
// The embedded scene: its closed form against the potential it comes from, its mesh against the bodies it fills.
#include "apps/scenes/sphere_flow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <random>

#include "mesh/predicates.hpp"

namespace cellproj {
namespace sphere_flow_test {

double potential(const glm::dvec3& p) {
    const double r = glm::length(p);
    return p.x + p.x / (2.0 * r * r * r);
}

// Fourth-order central difference of a function along an axis.
template <class Function>
double derivative(const Function& f, const glm::dvec3& p, int axis, double h) {
    glm::dvec3 e(0.0);
    e[axis] = h;
    return (8.0 * (f(p + e) - f(p - e)) - (f(p + 2.0 * e) - f(p - 2.0 * e))) / (12.0 * h);
}

// With h = 1e-3 the truncation error is h⁴/30 times a fifth derivative (below 1e4 for r ≥ 1): 3e-10; rounding adds
// about 1e-16/h times a few: 1e-12.
constexpr double h = 1e-3;
constexpr double difference_error = 1e-9;

std::vector<glm::dvec3> points_outside_the_sphere() {
    constexpr std::uint64_t seed = 20240607;
    std::cout << "seed " << seed << '\n';
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> coordinate(-sphere_flow_box, sphere_flow_box);
    std::vector<glm::dvec3> points;
    while (points.size() < 500) {
        const glm::dvec3 p(coordinate(random), coordinate(random), coordinate(random));
        if (glm::length(p) > 1.0) points.push_back(p);
    }
    return points;
}

TEST(SphereFlow, VelocityIsTheGradientOfThePotential) {
    for (const glm::dvec3& p : points_outside_the_sphere()) {
        const glm::dvec3 u = sphere_flow_velocity(p);
        glm::dvec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(u[axis], derivative(potential, p, axis, h), difference_error);
            gradient[axis] = derivative(potential, p, axis, h);
        }
        // Cp by the same second way: |u| ≤ 3/2, so its error is 3 of the gradient's per axis.
        EXPECT_NEAR(sphere_pressure_coefficient(p), 1.0 - glm::dot(gradient, gradient), 9.0 * difference_error);
    }
}

TEST(SphereFlow, VelocityHasNoDivergence) {
    for (const glm::dvec3& p : points_outside_the_sphere()) {
        double divergence = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const auto component = [&](const glm::dvec3& q) { return sphere_flow_velocity(q)[axis]; };
            divergence += derivative(component, p, axis, h);
        }
        // One derivative more than above: three times a fifth derivative of u below 1e5.
        EXPECT_NEAR(divergence, 0.0, 1e-8);
    }
}

TEST(SphereFlow, NothingFlowsThroughTheSphere) {
    for (const glm::dvec3& p : points_outside_the_sphere()) {
        const glm::dvec3 normal = glm::normalize(p);
        EXPECT_NEAR(glm::dot(sphere_flow_velocity(normal), normal), 0.0, 1e-14);  // a dozen roundings of numbers ≤ 3/2
    }
}

TEST(SphereFlow, KnownPressures) {
    // Few roundings, of numbers near 1: 1e-15 or exact.
    EXPECT_NEAR(sphere_pressure_coefficient({1, 0, 0}), 1.0, 1e-15);
    EXPECT_NEAR(sphere_pressure_coefficient({-1, 0, 0}), 1.0, 1e-15);
    for (const double angle : {0.0, 0.7, 2.0, 4.5}) {
        EXPECT_NEAR(sphere_pressure_coefficient({0, std::cos(angle), std::sin(angle)}), -1.25, 2e-15);
    }
    // On the axis u = 1 − r⁻³, across it 1 + r⁻³/2.
    EXPECT_NEAR(sphere_pressure_coefficient({2, 0, 0}), 1.0 - 0.875 * 0.875, 1e-15);
    EXPECT_NEAR(sphere_pressure_coefficient({0, 2, 0}), 1.0 - 1.0625 * 1.0625, 1e-15);
    EXPECT_NEAR(sphere_pressure_coefficient({1e4, 0, 0}), 0.0, 1e-11);
}

// Meshed once for all tests below.
class SphereFlowMesh : public testing::Test {
protected:
    static void SetUpTestSuite() {
        MesherOptions options;
        options.program = CELLPROJ_MESHER_PROGRAM;
        mesh_ = make_sphere_flow_mesh(options);
    }
    static void TearDownTestSuite() { mesh_ = {}; }

    static TetMesh mesh_;
};

TetMesh SphereFlowMesh::mesh_;

TEST_F(SphereFlowMesh, HasAboutAHundredThousandPositiveCells) {
    EXPECT_GE(mesh_.tets.size(), 80000U);
    EXPECT_LE(mesh_.tets.size(), 130000U);
    validate(mesh_, "sphere flow");
    for (const auto& t : mesh_.tets) {
        ASSERT_EQ(orientation(mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]], mesh_.points[t[3]]), 1);
    }
}

TEST_F(SphereFlowMesh, FillsTheBoxAroundTheIcosphere) {
    const PiecewiseLinearComplex complex = make_sphere_flow_complex();
    double ball = 0.0;  // divergence theorem over the triangles, which are the sphere's; the box has quadrilaterals
    for (const auto& f : complex.facets) {
        if (f.size() != 3) continue;
        ball += glm::dot(complex.points[f[0]], glm::cross(complex.points[f[1]], complex.points[f[2]])) / 6.0;
    }
    EXPECT_GT(ball, 0.995 * 4.0 / 3.0 * std::acos(-1.0));  // outward, and close to the sphere's
    double volume = 0.0;
    for (CellId c = 0; c < mesh_.tets.size(); ++c)
        volume += signed_volume(mesh_, c);
    const double box = std::pow(2.0 * sphere_flow_box, 3);
    EXPECT_NEAR(volume, box - ball, 1e-11 * box);  // 1e5 summands, each rounded to 1e-16 of a sum below 512
}

TEST_F(SphereFlowMesh, SurfaceIsTheOneThatWasAskedFor) {
    const Adjacency adjacency = build_adjacency(mesh_);
    EXPECT_EQ(adjacency.overused_faces, 0U);
    std::size_t on_sphere = 0, on_box = 0;
    for (const BoundaryFace& face : boundary_faces(adjacency)) {
        bool sphere = true, box = true;
        for (const VertexId v : face_vertices(mesh_.tets[face.cell], face.face)) {
            const glm::dvec3& p = mesh_.points[v];
            sphere = sphere && std::abs(glm::length(p) - 1.0) < 1e-15 * 4;  // normalised: a few ulp
            box = box && std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) == sphere_flow_box;
        }
        on_sphere += sphere;
        on_box += box;
        ASSERT_TRUE(sphere || box);
    }
    EXPECT_EQ(on_sphere, 20U * 256U);  // an icosahedron's faces, four times cut in four: no vertex was added
    EXPECT_EQ(on_box, 6U * 64U * 2U);
}

TEST_F(SphereFlowMesh, IsFineNearTheSphereAndCoarseFarAway) {
    double near = 0.0, far = 0.0;
    std::size_t near_count = 0, far_count = 0;
    for (CellId c = 0; c < mesh_.tets.size(); ++c) {
        const double r = glm::length(mesh_.points[mesh_.tets[c][0]]);
        if (r < 1.2) near += signed_volume(mesh_, c), ++near_count;
        if (r > 3.5) far += signed_volume(mesh_, c), ++far_count;
    }
    ASSERT_GT(near_count, 0U);
    ASSERT_GT(far_count, 0U);
    EXPECT_GT(far / double(far_count), 100.0 * near / double(near_count));
}

TEST_F(SphereFlowMesh, CarriesItsFields) {
    ASSERT_EQ(mesh_.point_fields.size(), 2U);
    const Field& cp = mesh_.point_fields[0];
    const Field& velocity = mesh_.point_fields[1];
    EXPECT_EQ(cp.name, "cp");
    EXPECT_EQ(velocity.name, "velocity");
    EXPECT_EQ(velocity.components, 3);
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
        const glm::dvec3 u(velocity.values[3 * i], velocity.values[3 * i + 1], velocity.values[3 * i + 2]);
        ASSERT_NEAR(cp.values[i], 1.0 - glm::dot(u, u), 1e-15);  // Bernoulli
        ASSERT_EQ(cp.values[i], sphere_pressure_coefficient(mesh_.points[i]));
    }
    // The mesh reaches both extremes to within one edge (0.07) of the sphere: Cp = 1 − 9/4 sin²θ on it, so 9/4 · 0.07².
    const auto [low, high] = std::minmax_element(cp.values.begin(), cp.values.end());
    EXPECT_NEAR(*low, -1.25, 0.012);
    EXPECT_NEAR(*high, 1.0, 0.012);
}

TEST(SphereFlowScene, TransferFunctionShowsBeltAndLobesOnly) {
    const TransferFunction transfer = sphere_flow_transfer_function();
    EXPECT_EQ(transfer.extinction(0.0), 0.0);
    EXPECT_EQ(transfer.extinction(0.05), 0.0);
    EXPECT_EQ(transfer.extinction(-0.05), 0.0);
    EXPECT_GT(transfer.extinction(-1.25), 1.0);
    EXPECT_GT(transfer.extinction(1.0), 1.0);
    EXPECT_GT(transfer.color(-1.25).b, 3.0 * transfer.color(-1.25).r);  // blue
    EXPECT_GT(transfer.color(1.0).r, 3.0 * transfer.color(1.0).b);      // red
}

TEST(SphereFlowScene, CameraStandsOutsideTheBoxAndLooksAtTheSphere) {
    const Camera camera = sphere_flow_camera();
    EXPECT_EQ(camera.projection, Camera::Projection::perspective);
    EXPECT_GT(glm::length(camera.eye), std::sqrt(3.0) * sphere_flow_box);
    EXPECT_EQ(camera.center, glm::dvec3(0.0));
    // The sphere and its lobes (radius about 2) fit into the picture.
    const double half_view = glm::length(camera.eye) * std::tan(0.5 * camera.fov_y_degrees * std::acos(-1.0) / 180.0);
    EXPECT_GT(half_view, 2.0);
}

}  // namespace
}  // namespace cellproj
