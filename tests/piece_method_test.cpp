// SPDX-License-Identifier: BSD-3-Clause
//
// The methods `integral` and `exact`: their table, their light against the exact integral, the shaders against both.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "classify/piece_table.hpp"
#include "classify/segment_integral.hpp"
#include "classify/segment_method.hpp"
#include "project/camera.hpp"
#include "render/prepared_scene.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace piece_method_test {

struct Function {
    std::string name;
    TransferFunction transfer;
};

std::vector<ColorNode> rainbow() {
    return {{0, {0.1, 0.2, 0.9}}, {0.25, {0, 1, 0.3}}, {0.5, {1, 1, 0}}, {0.5, {0.2, 0, 1}}, {1, {1, 0.6, 0}}};
}

// Six tents of half width 1/128, optical depth 20 per unit; all nodes are float32 numbers.
std::vector<ExtinctionNode> peaks() {
    std::vector<ExtinctionNode> nodes;
    for (int i = 0; i < 6; ++i) {
        const double center = (10 + 20 * i) / 128.0;
        nodes.insert(nodes.end(), {{center - 1.0 / 128, 0}, {center, 20}, {center + 1.0 / 128, 0}});
    }
    return nodes;
}

TransferFunction many_nodes(OpticalModel model, int count) {
    std::vector<ColorNode> color;
    std::vector<ExtinctionNode> extinction;
    for (int i = 0; i < count; ++i) {
        const double s = i / 16384.0;
        color.push_back({s, {0.5 + 0.5 * std::sin(9 * s), 0.5 + 0.5 * std::cos(13 * s), s}});
        extinction.push_back({s, 3 + 3 * std::sin(20 * s)});
    }
    return {model, color, extinction};
}

// Nodes at float32 scalars, so that nothing but the method errs.
std::vector<Function> functions(OpticalModel model) {
    const std::string suffix = model == OpticalModel::density ? " (density)" : " (emitter)";
    return {{"one node" + suffix, {model, {{0.3, {1, 0.5, 0.2}}}, {{0.75, 2}}}},
            {"ramp" + suffix, {model, {{0, {0.1, 0.2, 0.9}}, {1, {1, 0.6, 0}}}, {{0, 0}, {1, 8}}}},
            {"steps" + suffix, {model, rainbow(), {{0.375, 0}, {0.375, 10}, {0.625, 10}, {0.625, 0.5}}}},
            {"peaks" + suffix, {model, rainbow(), peaks()}},
            {"glow" + suffix, {model, rainbow(), {{0, 0}}}},
            {"10,000 nodes" + suffix, many_nodes(model, 10000)}};
}

std::vector<Function> all_functions() {
    std::vector<Function> all = functions(OpticalModel::density);
    for (Function& f : functions(OpticalModel::emitter))
        all.push_back(std::move(f));
    return all;
}

std::unique_ptr<SegmentMethod> method(const std::string& text, const TransferFunction& transfer) {
    return make_segment_method(parse_method(text), transfer, 2.0, 0.03);
}

double error(const Light& a, const Light& b) {
    return std::max({std::abs(a.color.x - b.color.x), std::abs(a.color.y - b.color.y), std::abs(a.color.z - b.color.z),
                     std::abs(a.opacity - b.opacity)});
}

// Largest error over segments of all widths and lengths, in both directions.
double largest_error(const std::string& text, const TransferFunction& transfer) {
    const auto light = method(text, transfer);
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform(0, 1);
    double largest = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const double width = std::exp2(-20 * uniform(random)), length = 2 * std::exp2(-10 * uniform(random));
        const float s_f = static_cast<float>(uniform(random));
        const float s_b = static_cast<float>(std::clamp(s_f + width * (2 * uniform(random) - 1), 0.0, 1.0));
        const double e = error(light->light(s_f, s_b, length), integrate_segment(transfer, s_f, s_b, length));
        if (!(e <= largest)) largest = e;  // NaN is an error
    }
    return largest;
}

TEST(PieceTable, EveryPieceIsFoundByItsBin) {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (const Function& f : all_functions()) {
        const PieceTable table = make_piece_table(f.transfer);
        const auto begin = [&](std::size_t piece) { return table.texel(piece, 0).x; };
        EXPECT_EQ(begin(0), 0.0);
        EXPECT_EQ(begin(table.piece_count() - 1), 1.0);
        std::vector<float> scalars{0, 1, 1e-38F};
        for (std::size_t i = 1; i + 1 < table.piece_count(); ++i) {
            EXPECT_EQ(table.texel(i - 1, 0).y, begin(i));
            const auto node = static_cast<float>(begin(i));
            scalars.insert(scalars.end(), {std::nextafter(node, 0.0F), node, std::nextafter(node, 1.0F), uniform(random)});
        }
        for (const float s : scalars) {
            const std::size_t piece = table.piece_of(s);
            ASSERT_LE(begin(piece), s) << f.name;
            if (piece + 1 < table.piece_count()) {
                ASSERT_GT(begin(piece + 1), s) << f.name;
            }
        }
    }
}

TEST(PieceTable, RunningIntegralsKeepTheirDigitsBehindStrongPieces) {
    const TransferFunction transfer(OpticalModel::density, {{0, {1, 0.5, 0}}},
                                    {{0, 1e9}, {0.25, 1e9}, {0.25, 1e-3}, {0.5, 1e-3}, {0.5, 0}});
    const PieceTable table = make_piece_table(transfer);
    const std::size_t from = table.piece_of(0.25F), to = table.piece_of(0.5F);
    const glm::dvec4 sum = (table.texel(to, 3) - table.texel(from, 3)) + (table.texel(to, 4) - table.texel(from, 4));
    EXPECT_NEAR(sum.w, 0.25e-3, 1e9 * 0x1p-48);  // two float32 hold 48 bits of what came before
    EXPECT_NEAR(sum.y, 0.5 * sum.w, 1e9 * 0x1p-48);
}

TEST(PieceTable, NodesThatFloat32CannotTellApartLeaveTheStep) {
    const double x = 0.3, y = std::nextafter(x, 1.0), z = std::nextafter(y, 1.0);
    const TransferFunction transfer(OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 1}, {x, 1}, {y, 50}, {z, 4}, {1, 4}});
    const auto light = method("exact:1e-6", transfer);
    // 1·0.3 + 4·0.7; the spike of two float64 steps is nothing; 1e-7: the node is off by less than a float32 step.
    EXPECT_NEAR(light->light(0, 1, 0.5).opacity, -std::expm1(-0.5 * 3.1), 1e-7);
}

TEST(PieceMethod, ExactKeepsItsTolerance) {
    for (const Function& f : all_functions()) {
        for (const double tolerance : {1e-2, 1e-3, 1e-5, 1e-7}) {
            const Method exact{.kind = MethodKind::exact, .tolerance = tolerance};
            // 2e-6: values, ends and running integrals of the table are float32.
            EXPECT_LE(largest_error(to_string(exact), f.transfer), tolerance + 2e-6) << f.name << " " << tolerance;
        }
    }
}

TEST(PieceMethod, IntegralStaysWithinItsErrors) {
    for (const Function& f : functions(OpticalModel::density))
        EXPECT_LE(largest_error("integral", f.transfer), 1e-3) << f.name;  // 10,000 nodes 4e-4, few nodes 2e-5
    for (const Function& f : functions(OpticalModel::emitter))
        EXPECT_LE(largest_error("integral", f.transfer), 5e-3) << f.name;  // of emissions up to 2 per segment
}

// The opacity is a closed form of the table: no choice of the method touches it above what is opaque to 1e-6.
TEST(PieceMethod, OpacityIsExactForAnyFunction) {
    for (const Function& f : all_functions()) {
        const auto light = method("integral", f.transfer);
        for (const float s : {0.0F, 0.1F, 0.37F, 0.5F, 0.93F})
            EXPECT_NEAR(light->light(s, 1 - s, 0.7).opacity, integrate_segment(f.transfer, s, 1 - s, 0.7).opacity, 1e-6) << f.name << s;
    }
}

TEST(PieceMethod, ExtremesAreFiniteAndAssociated) {
    const float x = 0.4F, y = std::nextafter(x, 1.0F), z = std::nextafter(y, 1.0F);
    std::vector<Function> all = all_functions();
    all.push_back({"spike of one float32 step", {OpticalModel::density, {{0, {1, 0.5, 0.2}}}, {{x, 0.1}, {y, 1e7}, {z, 0.1}}}});
    all.push_back({"depth 1e8", {OpticalModel::density, rainbow(), {{0, 0}, {1, 1e8}}}});
    all.push_back({"largest values", {OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0}, {0.5, 1e60}, {1, 0}}}});
    for (const Function& f : all) {
        for (const char* text : {"integral", "exact:1e-5"}) {
            const auto light = method(text, f.transfer);
            for (const float s_f : {0.0F, 1e-30F, x, y, z, 0.375F, std::nextafter(0.375F, 1.0F), 0.5F, 1.0F}) {
                for (const float s_b : {0.0F, 1e-30F, x, y, z, 0.375F, std::nextafter(0.375F, 0.0F), 0.5F, 1.0F}) {
                    EXPECT_EQ(light->light(s_f, s_b, 0).opacity, 0.0);
                    for (const double length : {1e-12, 1e-3, 2.0}) {
                        const Light value = light->light(s_f, s_b, length);
                        ASSERT_TRUE(value.opacity >= 0 && value.opacity <= 1) << f.name << s_f << " " << s_b;
                        for (int k = 0; k < 3; ++k)
                            ASSERT_TRUE(value.color[k] >= 0 && value.color[k] <= 4.0) << f.name << s_f << " " << s_b;
                        if (s_f != s_b && f.name != "largest values") {
                            // 2e-4: `integral` among 10,000 nodes and in steep pieces; float64 nodes are float32 here.
                            EXPECT_LE(error(value, integrate_segment(f.transfer, s_f, s_b, length)), 5e-3) << f.name << s_f << " " << s_b;
                        }
                    }
                }
            }
        }
    }
}

// ---- Shaders.

Renderer& renderer() {
    static const auto shared = make_renderer(Backend::gl_osmesa);
    return *shared;
}

// One cell, seen so that its corners fall on pixels' corners: nothing is snapped. What the fragment computes in float32
// is the method in float64.
TEST(PieceMethod, ShadersComputeTheSame) {
    const TetMesh mesh = testing_support::unit_tet();
    const auto f = [](const glm::dvec3& p) { return 0.25 + 0.5 * p.x + 0.125 * p.y - 0.25 * p.z; };
    const auto shared_mesh = std::make_shared<TetMesh>(mesh);
    const auto field = std::make_shared<ScalarField>(testing_support::point_field(mesh, f));
    const double low = 0, high = 0.75, unit = std::sqrt(3.0) / 2;
    const ImageSize size{96, 96};
    for (const Function& function : all_functions()) {
        const auto transfer = std::make_shared<TransferFunction>(function.transfer);
        for (const char* text : {"integral", "exact:1e-5"}) {
            const Method chosen = parse_method(text);
            const auto light = make_segment_method(chosen, in_scene_units(*transfer, low, high, unit), 2.0, 0.3);
            for (const double side : {1.0, -1.0}) {  // falling and rising scalars
                const Camera camera{.projection = Camera::Projection::parallel, .eye = {0.5, 0.5, 0.5 + 3 * side},
                                    .center = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .height = 1.5};
                const Image image = renderer().render({shared_mesh, field, transfer}, camera, size, {.method = chosen});
                const ScreenTransform transform(camera, size);
                int inside = 0;
                double largest = 0;
                for (int y = 0; y < size.height; ++y) {
                    for (int x = 0; x < size.width; ++x) {
                        const glm::dvec3 p = transform.ray({x + 0.5, y + 0.5}).origin;
                        const double height = 1 - p.x - p.y;
                        if (p.x < 0 || p.y < 0 || height < 0.02) continue;
                        ++inside;
                        const double top = f({p.x, p.y, height}) / high, base = f({p.x, p.y, 0}) / high;
                        const Light expected = side > 0 ? light->light(top, base, height / unit) : light->light(base, top, height / unit);
                        const glm::vec4 found = image.at(x, y);
                        const double e = error(expected, {glm::dvec3(found), found.w});
                        if (!(e <= largest)) largest = e;
                    }
                }
                EXPECT_GT(inside, 1500);
                // Peaks: τ changes by up to 2500 per unit of s, which is good to 1e-7 at both ends. Among 10,000 nodes, a block
                // at the limit of its depth may be taken in one precision and not in the other.
                const bool blocks = function.name.starts_with("10,000") && chosen.kind == MethodKind::integral;
                EXPECT_LE(largest, blocks ? 5e-4 : 5e-5) << function.name << " " << text << " " << side;
            }
        }
    }
}

// Rays along which the scalar is the same: all of the segment is in one piece, mostly not in the first of its cell.
TEST(PieceMethod, AConstantScalarAlongTheRayIsInItsOwnPiece) {
    const auto mesh = std::make_shared<TetMesh>(testing_support::unit_tet());
    const auto field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, [](const glm::dvec3& p) { return p.x; }));
    const Camera camera{.projection = Camera::Projection::parallel, .eye = {0.5, 0.5, 3.5}, .center = {0.5, 0.5, 0.5},
                        .up = {0, 1, 0}, .height = 1.5};
    const ImageSize size{96, 96};
    const ScreenTransform transform(camera, size);
    for (const Function& function : all_functions()) {
        const auto transfer = std::make_shared<TransferFunction>(function.transfer);
        for (const char* text : {"integral", "exact:1e-5"}) {
            const Image image = renderer().render({mesh, field, transfer}, camera, size, {.method = parse_method(text)});
            double largest = 0;
            for (int y = 0; y < size.height; ++y) {
                for (int x = 0; x < size.width; ++x) {
                    const glm::dvec3 p = transform.ray({x + 0.5, y + 0.5}).origin;
                    if (p.x < 0.001 || p.y < 0.001 || p.x + p.y > 0.98) continue;
                    // Within what float32 takes for the scalar: nodes of steps may lie there.
                    double least = 1e9;
                    for (const double shift : {-1e-6, 0.0, 1e-6}) {
                        const Light expected = integrate_segment(function.transfer, p.x + shift, p.x + shift, 1 - p.x - p.y);
                        least = std::min(least, error(expected, {glm::dvec3(image.at(x, y)), image.at(x, y).w}));
                    }
                    largest = std::max(largest, least);
                }
            }
            // Peaks rise by 2560 per unit of the scalar, which is good to 1e-7; an emitter is as bright as 2. Blocks: no.
            EXPECT_LE(largest, 3e-4) << function.name << " " << text;
        }
    }
}

// ---- Another transfer function.

TEST(PreparedScene, FindsTheVisibleCellsOfAnotherFunction) {
    const auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(8, 0.2, 3));
    const auto field = std::make_shared<ScalarField>(
        testing_support::point_field(*mesh, [](const glm::dvec3& p) { return p.x < 0.25 ? 0.5 : std::sin(5 * p.x * p.y) + p.z; }));
    std::vector<TransferFunction> transfers{
        {OpticalModel::density, {{0, {1, 1, 1}}}, {{0.3, 0}, {0.4, 1}, {0.5, 0}}},
        {OpticalModel::density, {{0, {1, 1, 1}}}, {{0.5, 3}}, Outside::transparent},  // visible at one scalar only
        {OpticalModel::emitter, {{0.9, {0, 0, 0}}, {0.9, {0, 1, 0}}}, {{0, 0}}},
        {OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0}}}};
    PreparedScene prepared({mesh, field, std::make_shared<TransferFunction>(transfers.front())});
    for (const TransferFunction& transfer : transfers) {
        prepared.set_transfer(std::make_shared<TransferFunction>(transfer));
        for (CellId cell = 0; cell < mesh->tets.size(); ++cell) {
            double low = 1e9, high = -1e9;
            for (int corner = 0; corner < 4; ++corner) {
                low = std::min(low, field->at(*mesh, cell, corner));
                high = std::max(high, field->at(*mesh, cell, corner));
            }
            ASSERT_EQ(transfer.visible(low, high), prepared.visible()[cell]) << low << " " << high;
        }
    }
}

}  // namespace
}  // namespace cellproj
