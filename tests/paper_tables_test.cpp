// SPDX-License-Identifier: BSD-3-Clause
//
// The tables of the papers, from their numbers (classify/papers.md).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "classify/half_opacity.hpp"
#include "classify/segment_integral.hpp"
#include "classify/segment_method.hpp"
#include "render/gl/osmesa_context.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/renderer.hpp"
#include "tests/support/layers.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace paper_tables_test {

using testing_support::through_stacked_cells;

// WVG91's example, from its numbers: half of the light behind comes through (optical depth ln 2), and one cell's C·D is
// 127.5, half of 8 bits. The exact colour is then 127.5 · ½/ln 2 = 91.97.
const double depth = std::log(2.0);
constexpr double emission = 127.5;
const double exact_color = emission * 0.5 / std::log(2.0);

// Colours in 1/255, length 1.
TransferFunction example() {
    return {OpticalModel::emitter, {{0, {emission / 255, 0, 0}}}, {{0, depth}}};
}

// `count` equal cells one behind the other.
Light stacked(const Light& cell, int count) {
    Light light;
    for (int i = 0; i < count; ++i) light = composite(cell, light);
    return light;
}

Light through(const Method& method, int count) {
    return stacked(make_segment_method(method, example(), 1, 1)->light(0.5, 0.5, 1.0 / count), count);
}

struct Row {
    int cells;
    double color, opacity;  // as printed
};

// Printed digits: half a unit of the last one.
void expect_printed(const Light& light, const Row& row) {
    EXPECT_NEAR(255 * light.color.x, row.color, 0.005 + 1e-9) << row.cells << " cells";
    EXPECT_NEAR(light.opacity, row.opacity, 0.0005 + 1e-9) << row.cells << " cells";
}

// Table 1: with the exponential integration any subdivision gives 91.97 / .500 …
TEST(WilhelmsVanGelder, Table1Exponential) {
    for (const MethodKind kind : {MethodKind::shirley_tuchman, MethodKind::homogeneous, MethodKind::linear}) {
        for (const int cells : {1, 2, 5, 10, 50, 100, 10000})
            expect_printed(through({.kind = kind, .size = 3}, cells), {cells, 91.97, 0.5});
    }
}

// … where C·D starts at 127.50 / .693 and comes near it with the number of cells.
constexpr std::array<Row, 7> table_1{{{1, 127.50, 0.693}, {2, 105.41, 0.573}, {5, 96.72, 0.526}, {10, 94.26, 0.512},
                                      {50, 92.42, 0.502}, {100, 92.19, 0.501}, {10000, 91.97, 0.500}}};

TEST(WilhelmsVanGelder, Table1Average) {
    for (const Row& row : table_1) expect_printed(through({.kind = MethodKind::average}, row.cells), row);
}

// C·D (Eq. 9–10) by itself: the colour is not attenuated by its own cell, and the opacity is the optical depth.
Light c_times_d(int cells) {
    return {{emission / 255 / cells, 0, 0}, depth / cells};
}

// §3.2: half of the opacity before, half after the colour. Three blendings are one with the light of half_opacity.
TEST(HalfOpacity, IsThreePassesInOne) {
    const Light behind{{0.7, 0.2, 0.4}, 0.6};
    for (const double opacity : {0.0, 1e-12, 0.3, 1.0}) {
        const Light cell{{0.5, 0.25, 3.0}, opacity}, half{glm::dvec3(0), opacity / 2}, color{cell.color, 0};
        const Light passes = composite(half, composite(color, composite(half, behind)));
        const Light once = composite(half_opacity(cell), behind);
        EXPECT_NEAR(once.opacity, passes.opacity, 1e-15);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(once.color[k], passes.color[k], 1e-15);
    }
}

// Per cell of depth D: the colour errs by −D³/6 instead of D²/2, the opacity by D²/4 instead of D²/2 (the next terms of
// the exponential are a share D of these).
TEST(HalfOpacity, TheColourIsRightToSecondOrder) {
    for (const double d : {0.1, 0.01, 0.001}) {
        const double exact = -std::expm1(-d);
        const Light average{glm::dvec3(d), d}, half = half_opacity(average);
        EXPECT_NEAR((average.color.x - exact) / (d * d), 1.0 / 2, d);
        EXPECT_NEAR((half.color.x - exact) / (d * d * d), -1.0 / 6, d);
        EXPECT_NEAR((average.opacity - exact) / (d * d), 1.0 / 2, d);
        EXPECT_NEAR((half.opacity - exact) / (d * d), 1.0 / 4, d);
    }
}

// Where a medium is so deep that nothing behind is seen, C·D shows its colour whatever the cells are, and three passes a
// darker one: each cell adds d·(1 − d/2) and takes d·(1 − d/4).
TEST(HalfOpacity, DarkensADeepMedium) {
    for (const double d : {0.5, 0.1, 0.02}) {
        const Light average{glm::dvec3(d), d};
        const int cells = static_cast<int>(40 / d);  // e^(−40) is left
        EXPECT_NEAR(stacked(average, cells).color.x, 1, 1e-9);
        EXPECT_NEAR(stacked(half_opacity(average), cells).color.x, (1 - d / 2) / (1 - d / 4), 1e-9);
    }
}

// So n cells let through what 2n cells do with C·D, exactly: the error of the whole still falls with 1/n only.
TEST(HalfOpacity, OnTheExampleOfTable1) {
    constexpr std::array<Row, 7> printed{{{1, 83.31, 0.573}, {2, 88.72, 0.533}, {5, 90.88, 0.512}, {10, 91.45, 0.506},
                                          {50, 91.87, 0.501}, {100, 91.92, 0.501}, {10000, 91.97, 0.500}}};
    for (const Row& row : printed) {
        const int n = row.cells;
        const Light half = stacked(half_opacity(c_times_d(n)), n);
        expect_printed(half, row);
        expect_printed(through({.kind = MethodKind::average, .blending = Blending::half}, n), row);
        EXPECT_NEAR(half.opacity, stacked(c_times_d(2 * n), 2 * n).opacity, 1e-11);
        // Σ of C/n·r·r²ᵏ over the cells k in front, r = 1 − D/2n: a geometric series.
        const double r = 1 - depth / (2.0 * n);
        EXPECT_NEAR(half.color.x, emission / 255 / n * r * (1 - std::pow(r, 2 * n)) / (1 - r * r), 1e-12);
    }
}

// ---- Table 2: one cell split into n, exponential integration, composited in different precisions.

// What a format makes of a number in 0..1.
using Store = double (*)(double);
double as_double(double v) { return v; }
double as_float(double v) { return static_cast<float>(v); }
double as_16_bits(double v) { return std::round(v * 65535) / 65535; }
double as_8_bits(double v) { return std::round(v * 255) / 255; }
// 11 binary digits, rounded down as Mesa's software driver does; numbers here are above its denormals.
double as_half_float(double v) {
    int exponent = 0;
    const double digits = std::frexp(v, &exponent);
    return std::ldexp(std::floor(std::ldexp(digits, 11)), exponent - 11);
}

// `count` cells over each other. Fixed point rounds a cell before it is blended (`source`), and all formats the result.
Light stacked_in(int count, Store source, Store result) {
    const Light cell = make_segment_method({.kind = MethodKind::shirley_tuchman}, example(), 1, 1)->light(0.5, 0.5, 1.0 / count);
    const Light front{{source(cell.color.x), 0, 0}, source(cell.opacity)};
    Light light;
    for (int i = 0; i < count; ++i) {
        light = composite(front, light);
        light = {{result(light.color.x), 0, 0}, result(light.opacity)};
    }
    return light;
}

struct PrecisionRow {
    int cells;
    double bits_16, bits_8, half_float;  // colours; double and float give 91.97 in every row
};

// As classify/papers.md prints them: to half a unit of the last digit.
constexpr std::array<PrecisionRow, 5> table_2{{{1, 91.97, 92.00, 91.95},
                                               {2, 91.97, 92.00, 91.95},
                                               {10, 91.98, 89.00, 91.77},
                                               {50, 92.01, 104.00, 91.20},
                                               {100, 92.09, 64.00, 90.40}}};

TEST(WilhelmsVanGelder, Table2Arithmetic) {
    const auto color = [](const Light& light) { return 255 * light.color.x; };
    for (const PrecisionRow& row : table_2) {
        const int n = row.cells;
        EXPECT_NEAR(color(stacked_in(n, as_double, as_double)), exact_color, 1e-10) << n;
        EXPECT_NEAR(color(stacked_in(n, as_float, as_float)), exact_color, 255.0 * n * std::ldexp(1.0, -24)) << n;
        EXPECT_NEAR(color(stacked_in(n, as_16_bits, as_16_bits)), row.bits_16, 0.006) << n;
        EXPECT_NEAR(color(stacked_in(n, as_8_bits, as_8_bits)), row.bits_8, 0.006) << n;
        EXPECT_NEAR(color(stacked_in(n, as_double, as_half_float)), row.half_float, 0.006) << n;
    }
}

// The formats of this machine's OpenGL do the same, to the digit.
TEST(WilhelmsVanGelder, Table2Drawn) {
    const auto renderer = make_renderer(Backend::gl_osmesa);
    struct Format {
        TargetFormat format;
        Store source, result;
        double per_cell;  // what a cell in float32 may add
    };
    for (const auto& [format, source, result, per_cell] :
         {Format{TargetFormat::rgba32f, as_double, as_double, std::ldexp(1.0, -24)},
          Format{TargetFormat::rgba16f, as_double, as_half_float, 0}, Format{TargetFormat::rgba16, as_16_bits, as_16_bits, 0},
          Format{TargetFormat::rgba8, as_8_bits, as_8_bits, 0}}) {
        for (const PrecisionRow& row : table_2) {
            const Light expected = stacked_in(row.cells, source, result);
            const glm::vec4 drawn = through_stacked_cells(*renderer, row.cells, example(), {.target = format});
            EXPECT_NEAR(drawn.x, expected.color.x, row.cells * per_cell + 1e-6) << to_string(format) << ", " << row.cells;
            EXPECT_NEAR(drawn.w, expected.opacity, row.cells * per_cell + 1e-6) << to_string(format) << ", " << row.cells;
        }
    }
}

// ---- RKE00: the time does not depend on the transfer function, because what is drawn does not: the same triangles, by
// the same instructions, over a table of the same size.
TEST(RoettgerKrausErtl, TheWorkDoesNotDependOnTheTransferFunction) {
    const Method method{.kind = MethodKind::preint3d, .size = 16};
    std::vector<ExtinctionNode> many;
    for (int i = 0; i < 10000; ++i) many.push_back({i / 9999.0, i % 2 == 0 ? 0.1 : 8.0});
    const auto function = [](const std::vector<ExtinctionNode>& nodes) {
        return TransferFunction(OpticalModel::density, {{0, {1, 1, 1}}}, nodes);
    };
    const TransferFunction plain = function({{0, 1}}), jagged = function(many);

    const auto renderer = make_renderer(Backend::gl_osmesa);
    const auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(6, 0.2, 3));
    const auto field = std::make_shared<ScalarField>(
        testing_support::point_field(*mesh, [](const glm::dvec3& p) { return (p.x + p.y + p.z) / 3; }));
    const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, Camera::Projection::perspective, {1.3, -2.1, 0.9}, {0, 0, 1}, 1.0);
    const auto triangles = [&](const TransferFunction& transfer) {
        Statistics statistics;
        const Scene scene{mesh, field, std::make_shared<TransferFunction>(transfer)};
        renderer->render(scene, camera, {64, 64}, {.method = method}, &statistics);
        return statistics.counts.triangles;
    };
    EXPECT_GT(triangles(plain), 1000U);
    EXPECT_EQ(triangles(plain), triangles(jagged));

    gl::OsmesaContext context(RendererOptions().osmesa_library);
    context.make_current();
    const auto a = gl::make_segment_shader(method, plain, FieldsRead::one, 2, 0.1), b = gl::make_segment_shader(method, jagged, FieldsRead::one, 2, 0.1);
    EXPECT_EQ(a->source(), b->source());
    EXPECT_EQ(a->table_bytes(), b->table_bytes());
}

}  // namespace
}  // namespace cellproj
