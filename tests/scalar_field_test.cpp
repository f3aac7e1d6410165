// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/scalar_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mesh/error.hpp"

namespace cellproj {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TetMesh one_tet() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}, {}};
}

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
    TetMesh mesh = one_tet();
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
    TetMesh mesh = one_tet();
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
    TetMesh mesh = one_tet();
    mesh.point_fields = {point_scalar("Pressure", 1), point_scalar("T", 2), point_scalar("t", 3)};
    mesh.cell_fields = {cell_scalar("Pressure", 4)};
    EXPECT_EQ(select_scalar(mesh, "pressure", "").name, "Pressure");  // one spelling, though on points and on cells
    EXPECT_EQ(select_scalar(mesh, "t", "").values[0], 3.0);
    mesh.cell_fields.push_back(cell_scalar("PRESSURE", 5));
    EXPECT_EQ(error_of(mesh, "pressure").kind(), ErrorKind::option);
    EXPECT_EQ(select_scalar(mesh, "PRESSURE", "").values[0], 5.0);
}

TEST(SelectScalar, WithoutANameTakesTheFirstScalarThenTheFirstField) {
    TetMesh mesh = one_tet();
    mesh.point_fields = {{"U", 3, std::vector<double>(12, 1.0)}};
    EXPECT_EQ(select_scalar(mesh, "", "").name, "U");
    mesh.cell_fields = {cell_scalar("c", 1)};
    EXPECT_EQ(select_scalar(mesh, "", "").name, "c");
    mesh.point_fields.push_back(point_scalar("s", 1));
    EXPECT_EQ(select_scalar(mesh, "", "").name, "s");
}

TEST(SelectScalar, ListsWhatThereIsWhenTheNameIsUnknown) {
    TetMesh mesh = one_tet();
    mesh.point_fields = {point_scalar("Density", 1)};
    mesh.cell_fields = {{"Velocity", 3, {1, 2, 3}}};
    const Error error = error_of(mesh, "Densty");
    EXPECT_EQ(error.kind(), ErrorKind::option);
    EXPECT_EQ(error.place(), "wing.vtu");
    EXPECT_EQ(error.expected(), "one of the fields \"Density\" (points), \"Velocity\" (3 components, cells)");
    EXPECT_NE(error.advice().find("\"Density\""), std::string::npos);
}

TEST(SelectScalar, SaysSoWhenThereIsNoField) {
    EXPECT_EQ(error_of(one_tet(), "").kind(), ErrorKind::data);
    EXPECT_EQ(error_of(one_tet(), "p").kind(), ErrorKind::data);
}

TEST(ScalarField, AtLooksUpTheVertexOrTheCell) {
    TetMesh mesh = one_tet();
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
