// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/scalar_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mesh/dataset.hpp"
#include "mesh/error.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace scalar_field_test {

using testing_support::unit_tet;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Field point_scalar(const std::string& name, double first) {
    return {name, 1, {first, 1, 2, 3}};
}
Field cell_scalar(const std::string& name, double value) {
    return {name, 1, {value}};
}

Error error_of(const TetMesh& mesh, const std::string& name) {
    try {
        select_scalar(mesh, name, "wing.vtu");
    } catch (const Error& error) {
        return error;
    }
    throw std::logic_error("no error was thrown");
}

TEST(SelectScalar, TakesPointFieldsBeforeCellFields) {
    TetMesh mesh = unit_tet();
    mesh.cell_fields = {cell_scalar("p", 7), cell_scalar("t", 8)};
    mesh.point_fields = {point_scalar("p", -1)};
    const ScalarField p = select_scalar(mesh, "p", "");
    EXPECT_EQ(p.location, FieldLocation::points);
    EXPECT_EQ(p.values, (std::vector<double>{-1, 1, 2, 3}));
    const ScalarField t = select_scalar(mesh, "t", "");
    EXPECT_EQ(t.location, FieldLocation::cells);
    EXPECT_EQ(t.values, (std::vector<double>{8}));
}

TEST(SelectScalar, GivesTheMagnitudeOfVectorsAndKeepsTheSignOfScalars) {
    TetMesh mesh = unit_tet();
    mesh.point_fields = {{"U", 3, {2, 3, 6, -1, 2, -2, 0, 0, 0, nan, 0, 0}}, point_scalar("p", -5)};
    const std::vector<double> u = select_scalar(mesh, "U", "").values;
    ASSERT_EQ(u.size(), 4U);
    EXPECT_EQ(u[0], 7.0);  // 4 + 9 + 36
    EXPECT_EQ(u[1], 3.0);  // 1 + 4 + 4
    EXPECT_EQ(u[2], 0.0);
    EXPECT_TRUE(std::isnan(u[3]));
    EXPECT_EQ(select_scalar(mesh, "p", "").values[0], -5.0);
}

TEST(SelectScalar, AcceptsAnotherCaseOnlyWhereItIsUnique) {
    TetMesh mesh = unit_tet();
    mesh.point_fields = {point_scalar("Pressure", 1), point_scalar("T", 2), point_scalar("t", 3)};
    mesh.cell_fields = {cell_scalar("Pressure", 4)};
    EXPECT_EQ(select_scalar(mesh, "pressure", "").name, "Pressure");  // one spelling, though on points and on cells
    EXPECT_EQ(select_scalar(mesh, "t", "").values[0], 3.0);
    mesh.cell_fields.push_back(cell_scalar("PRESSURE", 5));
    EXPECT_EQ(error_of(mesh, "pressure").kind(), ErrorKind::option);
    EXPECT_EQ(select_scalar(mesh, "PRESSURE", "").values[0], 5.0);
}

TEST(SelectScalar, WithoutANameTakesTheFirstScalarThenTheFirstField) {
    TetMesh mesh = unit_tet();
    mesh.point_fields = {{"U", 3, std::vector<double>(12, 1.0)}};
    EXPECT_EQ(select_scalar(mesh, "", "").name, "U");
    mesh.cell_fields = {cell_scalar("c", 1)};
    EXPECT_EQ(select_scalar(mesh, "", "").name, "c");
    mesh.point_fields.push_back(point_scalar("s", 1));
    EXPECT_EQ(select_scalar(mesh, "", "").name, "s");
}

// Ids, ghosts and constants stand first in many files (Exodus: GlobalNodeId); a vector says more than they do.
TEST(SelectScalar, WithoutANameTakesWhatVariesAndDoesNotCount) {
    TetMesh mesh = unit_tet();
    mesh.point_fields = {point_scalar("id", 0), {"T", 1, {300.5, 300.5, 300.5, 300.5}}, {"bad", 1, {nan, nan, nan, nan}}};
    EXPECT_EQ(field_to_look_at(mesh), "id");
    mesh.point_fields.push_back({"U", 3, {0.5, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}});
    EXPECT_EQ(field_to_look_at(mesh), "U");
    EXPECT_EQ(select_scalar(mesh, "", "").name, "U");
    mesh.point_fields.push_back({"p", 1, {1, nan, 2, 3.5}});
    EXPECT_EQ(field_to_look_at(mesh), "p");
    EXPECT_EQ(select_scalar(mesh, "", "").name, "p");
    // The last point is no point of the file: without it there are whole numbers only.
    EXPECT_EQ(field_to_look_at(mesh, 1), "U");
    EXPECT_EQ(select_scalar(mesh, "", "", 1).name, "U");
    EXPECT_EQ(field_to_look_at(unit_tet()), std::nullopt);
}

TEST(SelectScalar, DoesNotSuggestANameThatDrawsAnotherField) {
    TetMesh mesh = unit_tet();
    mesh.tets.push_back(mesh.tets[0]);
    mesh.cell_fields = {{"p", 1, {1.5, 2.5}}};
    EXPECT_EQ(field_to_look_at(mesh), "p");
    mesh.point_fields = {{"p", 1, {7, 7, 7, 7}}};
    EXPECT_EQ(field_to_look_at(mesh), std::nullopt);
}

TEST(SelectScalar, CoordinatesAreThereWithoutAnyField) {
    TetMesh mesh = unit_tet();  // the origin and the unit points of the axes
    EXPECT_EQ(select_scalar(mesh, "Points:z", "").values, (std::vector<double>{0, 0, 0, 1}));
    EXPECT_EQ(select_scalar(mesh, "points:0", "").name, "Points:x");
    EXPECT_EQ(select_scalar(mesh, "Points:y", "").location, FieldLocation::points);
    EXPECT_NE(error_of(mesh, "Points:w").expected().find("a component of"), std::string::npos);
    EXPECT_NE(error_of(mesh, "").advice().find("Points:z"), std::string::npos);
    mesh.point_fields = {{"Points", 3, std::vector<double>(12, 9.0)}};
    EXPECT_EQ(select_scalar(mesh, "Points:z", "").values, (std::vector<double>(4, 9.0)));  // a field of that name comes first
}

TEST(SelectScalar, ListsWhatThereIsWhenTheNameIsUnknown) {
    TetMesh mesh = unit_tet();
    mesh.point_fields = {point_scalar("Density", 1)};
    mesh.cell_fields = {{"Velocity", 3, {1, 2, 3}}};
    const Error error = error_of(mesh, "Densty");
    EXPECT_EQ(error.kind(), ErrorKind::option);
    EXPECT_EQ(error.place(), "wing.vtu");
    EXPECT_EQ(error.expected(), "one of the fields \"Density\" (points), \"Velocity\" (3 components, cells)");
    EXPECT_NE(error.advice().find("\"Density\""), std::string::npos);
}

TEST(SelectScalar, SaysSoWhenThereIsNoField) {
    EXPECT_EQ(error_of(unit_tet(), "").kind(), ErrorKind::data);
    EXPECT_EQ(error_of(unit_tet(), "p").kind(), ErrorKind::data);
}

TEST(SelectScalar, GivesOneComponentBehindAColon) {
    TetMesh mesh = unit_tet();
    mesh.point_fields = {{"U", 3, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}}, point_scalar("a:x", 20)};
    mesh.cell_fields = {{"T", 9, {0, 1, 2, 3, 4, 5, 6, 7, 8}}, {"a", 2, {30, 31}}};
    const ScalarField z = select_scalar(mesh, "U:z", "");
    EXPECT_EQ(z.name, "U:z");
    EXPECT_EQ(z.location, FieldLocation::points);
    EXPECT_EQ(z.values, (std::vector<double>{3, 6, 9, 12}));
    EXPECT_EQ(select_scalar(mesh, "u:0", "").values, (std::vector<double>{1, 4, 7, 10}));
    EXPECT_EQ(select_scalar(mesh, "U:0", "").name, "U:x");
    EXPECT_EQ(select_scalar(mesh, "T:8", "").values, (std::vector<double>{8}));
    EXPECT_EQ(select_scalar(mesh, "T:8", "").location, FieldLocation::cells);
    EXPECT_EQ(select_scalar(mesh, "T:8", "").name, "T:8");
    EXPECT_EQ(select_scalar(mesh, "a:x", "").values[0], 20.0);  // a name with a colon
    EXPECT_EQ(select_scalar(mesh, "a:y", "").values[0], 31.0);
    EXPECT_EQ(select_scalar(mesh, "a:x:x", "").values[0], 20.0);
}

TEST(SelectScalar, RefusesComponentsThatAreNotThere) {
    TetMesh mesh = unit_tet();
    mesh.cell_fields = {{"U", 3, {1, 2, 3}}, {"V", 2, {1, 2}}, cell_scalar("p", 1)};
    for (const char* name : {"U:3", "U:-1", "U:w", "U:", "U:xy", "V:z", "p:y", "U:0x"}) {
        const Error error = error_of(mesh, name);
        EXPECT_EQ(error.kind(), ErrorKind::option) << name;
        EXPECT_NE(error.expected().find("a component of"), std::string::npos) << name;
    }
    EXPECT_NE(error_of(mesh, "W:x").expected().find("one of the fields"), std::string::npos);
}

// A regular grid of n³ points at spacing h, cut by the alternating split.
TetMesh grid_mesh(std::size_t n, double h) {
    Dataset dataset;
    dataset.source = "grid";
    for (std::size_t p = 0; p < n * n * n; ++p) {
        dataset.points.push_back(h * glm::dvec3(p % n, p / n % n, p / (n * n)));
    }
    dataset.grid = GridDimensions{n, n, n};
    return tetrahedralize(dataset);
}

double linear(const glm::dvec3& p) {
    return 3.0 - 2.0 * p.x + 5.0 * p.y + 0.5 * p.z;
}

// The linear function at the centroid of each tetrahedron, which is its mean there.
ScalarField linear_means(const TetMesh& mesh) {
    ScalarField field{"s", FieldLocation::cells, {}};
    for (const auto& t : mesh.tets) {
        field.values.push_back(
            linear(0.25 * (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]])));
    }
    return field;
}

TEST(AveragedToPoints, AConstantStaysConstant) {
    TetMesh mesh = grid_mesh(4, 0.3);
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
        mesh.points[p] += 0.02 * std::sin(static_cast<double>(7 * p));
    const ScalarField average =
        averaged_to_points(mesh, {"c", FieldLocation::cells, std::vector<double>(mesh.tets.size(), 0.7)});
    EXPECT_EQ(average.location, FieldLocation::points);
    EXPECT_EQ(average.name, "c");
    ASSERT_EQ(average.values.size(), mesh.points.size());
    // Sums of at most 32 products, each rounded twice.
    for (const double value : average.values)
        EXPECT_NEAR(value, 0.7, 64 * 1.2e-16);
}

TEST(AveragedToPoints, ReproducesALinearFieldWithinItsBounds) {
    const std::size_t n = 5;
    const double h = 0.25;
    const TetMesh mesh = grid_mesh(n, h);
    const ScalarField average = averaged_to_points(mesh, linear_means(mesh));
    const double gradient = std::sqrt(4.0 + 25.0 + 0.25);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const auto inner = [&](std::size_t i) { return i > 0 && i + 1 < n; };
        const double error = std::abs(average.values[p] - linear(mesh.points[p]));
        // The alternating split is symmetric around inner points; elsewhere a mean lies in a cell around the point.
        if (inner(p % n) && inner(p / n % n) && inner(p / (n * n))) {
            EXPECT_LT(error, 1e-13);
        } else {
            EXPECT_LT(error, gradient * h * std::sqrt(3.0));
        }
    }
}

TEST(AveragedToPoints, WeighsByVolume) {
    // Two tetrahedra on the face 0 1 2, of heights 3 and 1; a flat one at the corners 3, 5, 6, 7; the point 8 is alone.
    const TetMesh mesh{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 3}, {0, 0, -1}, {1, 0, 3}, {0, 1, 3}, {1, 1, 3}, {9, 9, 9}},
        {{0, 1, 2, 3}, {0, 2, 1, 4}, {3, 5, 6, 7}},
        {},
        {}};
    const std::vector<double> values = averaged_to_points(mesh, {"c", FieldLocation::cells, {10, 30, 50}}).values;
    for (const std::size_t shared : {0U, 1U, 2U})
        EXPECT_DOUBLE_EQ(values[shared], 15.0);
    EXPECT_DOUBLE_EQ(values[3], 10.0);
    EXPECT_DOUBLE_EQ(values[4], 30.0);
    EXPECT_DOUBLE_EQ(values[5], 50.0);
    EXPECT_TRUE(std::isnan(values[8]));
    const ScalarField on_points{"p", FieldLocation::points, {1, 2, 3}};
    EXPECT_EQ(averaged_to_points(mesh, on_points).values, on_points.values);
}

TEST(ScalarField, AtLooksUpTheVertexOrTheCell) {
    TetMesh mesh = unit_tet();
    mesh.tets = {{3, 1, 2, 0}};
    const ScalarField on_points{"", FieldLocation::points, {10, 11, 12, 13}};
    const ScalarField on_cells{"", FieldLocation::cells, {5}};
    EXPECT_EQ(on_points.at(mesh, 0, 0), 13.0);
    EXPECT_EQ(on_points.at(mesh, 0, 3), 10.0);
    EXPECT_EQ(on_cells.at(mesh, 0, 3), 5.0);
}

TEST(Range, LeavesOutWhatIsNotFinite) {
    const ScalarRange mixed = range({nan, -3, infinity, 8, 2, -infinity});
    EXPECT_EQ(mixed.low, -3.0);
    EXPECT_EQ(mixed.high, 8.0);
    EXPECT_EQ(mixed.not_finite, 3U);
    const ScalarRange above_zero = range({4, 2});  // 0 is no value of its own
    EXPECT_EQ(above_zero.low, 2.0);
    EXPECT_EQ(above_zero.high, 4.0);
    const ScalarRange none = range({nan});
    EXPECT_EQ(none.low, 0.0);
    EXPECT_EQ(none.high, 0.0);
    EXPECT_EQ(none.not_finite, 1U);
}

TEST(WithFiniteValues, ReplacesNothingElse) {
    const ScalarField field{"f", FieldLocation::cells, {1, nan, -infinity, 0, infinity, -2}};
    const ScalarField finite = with_finite_values(field, 7);
    EXPECT_EQ(finite.values, (std::vector<double>{1, 7, 7, 0, 7, -2}));
    EXPECT_EQ(finite.location, FieldLocation::cells);
    EXPECT_EQ(finite.name, "f");
}

TEST(Quantile, HasTheGivenShareOfTheFiniteValuesBelowIt) {
    std::vector<double> values{nan, infinity};
    for (int i = 99; i >= 0; --i)
        values.push_back(i);
    EXPECT_EQ(quantile(values, 0.0), 0.0);
    EXPECT_EQ(quantile(values, 0.25), 25.0);
    EXPECT_EQ(quantile(values, 0.5), 50.0);
    EXPECT_EQ(quantile(values, 1.0), 99.0);
    EXPECT_EQ(quantile({nan}, 0.5), 0.0);
    EXPECT_EQ(quantile({}, 0.5), 0.0);
    EXPECT_EQ(quantile({3.5}, 1.0), 3.5);
}

}  // namespace
}  // namespace cellproj
