// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures of grids refined inside each other: closed forms, the judge of single grids, and no seam where levels meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "render/judge/hierarchy_reference.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grid_hierarchies.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace hierarchy_picture_test {

using testing_support::block;
using testing_support::constant_medium;
using testing_support::corner_refined;
using testing_support::hierarchy_of;
using testing_support::max_difference;
using testing_support::random_blocks;
using testing_support::unit_cube;
using testing_support::view_of_unit_cube;

using Projection = Camera::Projection;
const std::vector<Projection> projections{Projection::parallel, Projection::perspective};
constexpr ImageSize small = CELLPROJ_SANITIZED ? ImageSize{24, 20} : ImageSize{72, 70};  // more than one tile

HierarchyScene scene_of(GridHierarchy hierarchy, TransferFunction transfer) {
    return {std::make_shared<const GridHierarchy>(std::move(hierarchy)), std::make_shared<const TransferFunction>(std::move(transfer))};
}

HierarchyRenderer& cpu() {
    static const auto shared = make_hierarchy_renderer();
    return *shared;
}

std::vector<PixelTruth> truth_of(const HierarchyScene& scene, const Camera& camera) {
    return HierarchyReference(scene).pixels(camera, small, all_pixels(small));
}

// 1 − exp(−τ·chord) whatever the pieces, at every scale, far from the origin, from outside and from inside.
TEST(HierarchyPicture, AConstantMediumKnowsNoPieces) {
    std::mt19937_64 random(81);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 4 : 24); ++trial) {
        GridHierarchy unscaled = random_blocks(random, [](const glm::dvec3&) { return 7.0; });
        const double scale = std::pow(10, trial % 4 == 0 ? 12 * both(random) : 0);
        std::vector<Grid> pieces = unscaled.pieces;
        for (Grid& piece : pieces) {
            piece.blanked.clear();
            for (int a = 0; a < 3; ++a) {
                GridAxis& axis = piece.axes[static_cast<std::size_t>(a)];
                axis = uniform_axis(scale * (axis.coordinates.front() + (trial % 3 == 0 ? 1000.0 * a : 0)), scale * *axis.spacing, axis.points());
            }
        }
        const GridHierarchy hierarchy = hierarchy_of(std::move(pieces));
        const Bounds box = hierarchy.bounds();
        const double tau = 2 / glm::length(box.high - box.low);
        const HierarchyScene scene = scene_of(hierarchy, constant_medium(tau));
        Camera camera = frame_bounds(box, projections[static_cast<std::size_t>(trial % 2)], {both(random), both(random), 1}, {0, 1, 0}, 1);
        if (trial % 4 == 3) camera.eye = box.low + glm::dvec3(unit(random), unit(random), unit(random)) * (box.high - box.low);
        const ScreenTransform transform(camera, small);
        const Image image = cpu().render(scene, camera, small);
        double error = 0, judged = 0, brightest = 0;
        for (const PixelTruth& truth : truth_of(scene, camera)) {
            const double length = testing_support::chord_in_box(box, transform.ray({truth.pixel.x + 0.5, truth.pixel.y + 0.5}), transform.perspective());
            const double opacity = -std::expm1(-tau * length);
            judged = std::max(judged, std::abs(truth.light.opacity - opacity));
            error = std::max(error, std::abs(image.at(truth.pixel.x, truth.pixel.y).a - opacity));
            brightest = std::max(brightest, opacity);
        }
        EXPECT_LT(judged, 1e-10) << trial;  // that of GridReference, and as many chords as boxes
        EXPECT_LT(error, 5e-6) << trial;    // float32: 3e-6 in a grid, and a composition for each box
        EXPECT_GT(brightest, 0.3) << trial;
    }
}

// A linear field is one whatever the pieces: as in one grid.
TEST(HierarchyPicture, ALinearFieldIsThatOfOneGrid) {
    const auto linear = [](const glm::dvec3& p) { return (p.x + 2 * p.y + p.z) / 4; };
    for (const Projection projection : projections) {
        const Camera camera = view_of_unit_cube(projection);
        const HierarchyScene scene = scene_of(corner_refined(4, linear), testing_support::ramp());
        const GridReference one(std::make_shared<const Grid>(unit_cube(1, linear)), scene.transfer);
        const auto truths = one.pixels(camera, small, all_pixels(small));
        double judged = 0;
        const std::vector<PixelTruth> own = truth_of(scene, camera);
        for (std::size_t p = 0; p < truths.size(); ++p) judged = std::max(judged, testing_support::distance(own[p].light, truths[p].light));
        EXPECT_LT(judged, 1e-9);
        EXPECT_LT(largest(compare(cpu().render(scene, camera, small), truths)), 5e-6);
    }
}

// Refined 2:1 in a corner against refined everywhere. Of s = x² + y² + z², linear interpolation over H is too large by H²/8·s″ = H²/4 at
// most along each axis. So the coarse cells are within 3/4·H² above s; so are the fine cells' points on the border, which take the
// coarse value, and between them another 3/4·(H/2)²; the fully refined grid is within 3/4·(H/2)². Two numbers between s and s + δ differ
// by δ = 15/16·H² at most, optical depths by slope·δ·chord, opacities by no more than that: with one colour, colours, too. Rays along
// the border are under the same bound: no seam.
TEST(HierarchyPicture, ARefinedCornerIsWithinTheInterpolationErrorAndHasNoSeam) {
    const auto bowl = [](const glm::dvec3& p) { return glm::dot(p, p); };
    constexpr double slope = 2.0;
    const TransferFunction rising(OpticalModel::density, {{0, glm::dvec3(1)}}, {{0, 0}, {3, 3 * slope}});
    double previous = 1;
    for (const std::size_t n : {4U, 8U, 16U}) {
        const double h = 1.0 / static_cast<double>(n), delta = 15.0 / 16 * h * h;
        const HierarchyScene scene = scene_of(corner_refined(n, bowl), rising);
        const auto fine = std::make_shared<const Grid>(unit_cube(2 * n, bowl));
        const GridReference everywhere(fine, scene.transfer);
        double worst = 0;
        for (const Projection projection : projections) {
            Camera camera = view_of_unit_cube(projection);
            for (const bool along_the_border : {false, true}) {
                if (along_the_border) camera = {projection, {0.5, -3, 0.5 + 1e-4}, {0.5, 0.5, 0.5 + 1e-4}, {0, 0, 1}, 1.2, 25};
                const ScreenTransform transform(camera, small);
                const Image image = cpu().render(scene, camera, small, parse_method("exact:1e-6"));
                for (const PixelTruth& truth : everywhere.pixels(camera, small, all_pixels(small))) {
                    const double length = testing_support::chord_in_box(fine->bounds(), transform.ray({truth.pixel.x + 0.5, truth.pixel.y + 0.5}), transform.perspective());
                    const double error = testing_support::max_difference(glm::dvec4(image.at(truth.pixel.x, truth.pixel.y)),
                                                                         glm::dvec4(truth.light.color, truth.light.opacity));
                    ASSERT_LE(error, slope * delta * length + 1e-5) << n << " at " << truth.pixel.x << ' ' << truth.pixel.y;
                    worst = std::max(worst, error);
                }
            }
        }
        EXPECT_LT(worst, previous / 3);  // of second order
        EXPECT_GT(worst, 1e-5);          // the two are not the same
        previous = worst;
    }
}

// Values of any kind: the renderer against the judge, which knows no boxes.
TEST(HierarchyPicture, RandomFieldsAgainstTheJudge) {
    std::mt19937_64 random(82);
    std::uniform_real_distribution<double> unit(0, 1);
    const TransferFunction peaks{OpticalModel::density, {{0.2, {1, 0, 0}}, {0.5, {0, 1, 0}}, {0.8, {0, 0, 1}}}, {{0, 0.1}, {0.4, 0}, {0.5, 1}, {0.6, 0}, {1, 0.5}}};
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 2 : 8); ++trial) {
        GridHierarchy hierarchy = random_blocks(random, [&](const glm::dvec3&) { return unit(random); });
        if (trial % 4 == 3) {  // constant in cells
            std::vector<Grid> pieces = hierarchy.pieces;
            for (Grid& piece : pieces) {
                piece = {piece.axes, FieldLocation::cells, {}, {}};
                for (std::size_t c = 0; c < piece.cell_count(); ++c) piece.values.push_back(unit(random));
            }
            hierarchy = hierarchy_of(std::move(pieces));
        }
        const Camera camera = frame_bounds(hierarchy.bounds(), projections[static_cast<std::size_t>(trial % 2)], {1, -2, 0.7}, {0, 0, 1}, 1);
        const HierarchyScene scene = scene_of(std::move(hierarchy), peaks);
        const Image image = cpu().render(scene, camera, small, parse_method("exact:1e-5"));
        EXPECT_EQ(count_non_finite(image), 0U);
        EXPECT_LT(largest(compare(image, truth_of(scene, camera))), 2e-4) << trial;  // as single grids: noise is what is hardest to cut
    }
}

// Continuity: a layer thinner than what interpolation makes of a border is crossed by every ray that crosses its value.
TEST(HierarchyPicture, AThinLayerDoesNotGapeAtTheBorder) {
    const auto bowl = [](const glm::dvec3& p) { return glm::dot(p, p); };
    const TransferFunction thin(OpticalModel::density, {{0, glm::dvec3(1)}}, {{0, 0}, {0.7, 0}, {0.701, 3e4}, {0.702, 0}, {3, 0}});
    const HierarchyScene scene = scene_of(corner_refined(4, bowl), thin);
    const Camera camera{Projection::parallel, {-3, -3, -3}, {0, 0, 0}, {0, 0, 1}, 0.8};
    const int side = CELLPROJ_SANITIZED ? 16 : 40;
    const auto truths = HierarchyReference(scene).pixels(camera, {side, side}, all_pixels({side, side}));
    for (const PixelTruth& truth : truths) {
        // Rays near the diagonal pass from below .7 to above: each meets all of the layer, about .001/|∇s|·3e4/2 thick.
        const double off = std::hypot(truth.pixel.x - 0.5 * (side - 1), truth.pixel.y - 0.5 * (side - 1)) * 0.8 / side;
        if (off >= 0.3) continue;
        EXPECT_GT(truth.light.opacity, 0.999) << truth.pixel.x << ' ' << truth.pixel.y;
    }
}

TEST(HierarchyPicture, ThreadsDoNotMatterAndStatisticsTell) {
    const HierarchyScene scene = scene_of(corner_refined(6, [](const glm::dvec3& p) { return p.x * p.y; }), testing_support::ramp());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    Statistics statistics;
    const Image all = make_hierarchy_renderer(3)->render(scene, camera, small, {}, &statistics);
    EXPECT_EQ(max_difference(all, make_hierarchy_renderer(1)->render(scene, camera, small)), 0.0);
    EXPECT_EQ(max_difference(all, cpu().render(scene, camera, small)), 0.0);
    EXPECT_EQ(max_difference(all, cpu().render(scene, camera, small)), 0.0);  // and again, of what is kept
    EXPECT_EQ(statistics.counts.cells, 216U - 27U + 216U);
    EXPECT_TRUE(statistics.order_exact);
    EXPECT_EQ(statistics.plan.front().chosen, "2 in 2 levels");
    EXPECT_THROW(cpu().render(scene, camera, small, parse_method("homogeneous:vertices")), Error);
    const Camera away{Projection::perspective, {9, 9, 9}, {18, 18, 18}, {0, 0, 1}};
    const Image nothing = cpu().render(scene, away, small);
    for (const glm::vec4& pixel : nothing.pixels) ASSERT_EQ(pixel, glm::vec4(0));
}

}  // namespace
}  // namespace cellproj
