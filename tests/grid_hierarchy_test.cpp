// SPDX-License-Identifier: BSD-3-Clause
//
// Grids refined inside each other: where they lie, which boxes they make, and one scalar on both sides of every border.
#include "mesh/grid_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "mesh/error.hpp"
#include "tests/support/grid_hierarchies.hpp"

namespace cellproj {
namespace grid_hierarchy_test {

using testing_support::block;
using testing_support::corner_refined;
using testing_support::hierarchy_of;
using testing_support::random_blocks;

TEST(GridPieces, LieOnTheLatticeOfTheFinest) {
    const GridHierarchy hierarchy = corner_refined(4, [](const glm::dvec3& p) { return p.x; });
    const Lattice& lattice = hierarchy.lattice;
    EXPECT_EQ(lattice.levels, 2);
    EXPECT_EQ(lattice.pieces[0].step, (LatticeIndex{2, 2, 2}));
    EXPECT_EQ(lattice.pieces[0].box.high, (LatticeIndex{8, 8, 8}));
    EXPECT_EQ(lattice.pieces[1].level, 1);
    EXPECT_EQ(lattice.pieces[1].box.high, (LatticeIndex{4, 4, 4}));
    EXPECT_EQ(hierarchy.cell_count(), 64U + 64U);
    EXPECT_EQ(hierarchy.visible_cells(), 64U - 8U + 64U);
    EXPECT_EQ(hierarchy.bounds().high, glm::dvec3(1));
}

// Decimals of files, steps that differ along the axes, a piece that is finer along one axis only, places below 0.
TEST(GridPieces, RoundedNumbersAndUnevenRefinement) {
    const auto axes = [](double x, double h, std::size_t n) { return uniform_axis(x, h, n + 1); };
    const std::vector<std::array<GridAxis, 3>> pieces{{axes(-1, 1.0 / 3, 6), axes(0, 2, 2), axes(0, 1, 2)},
                                                      {axes(-0.33333, 0.11111, 6), axes(2, 0.5, 4), axes(1, 1, 1)}};
    const std::vector<std::string> names{"a", "b"};
    const Lattice lattice = place_pieces(pieces, names, "t");
    EXPECT_EQ(lattice.pieces[0].step, (LatticeIndex{3, 4, 1}));
    EXPECT_EQ(lattice.pieces[1].step, (LatticeIndex{1, 1, 1}));
    EXPECT_EQ(lattice.pieces[1].box.low, (LatticeIndex{6, 4, 1}));
    EXPECT_EQ(lattice.pieces[1].box.high, (LatticeIndex{12, 8, 2}));
    const auto covered = covered_cells(lattice, names, "t");
    EXPECT_EQ(std::count(covered[0].begin(), covered[0].end(), true), 2);
    EXPECT_TRUE(covered[0][2 + 6 * (1 + 2 * 1)]);
}

TEST(GridPieces, WhatDoesNotFitIsTold) {
    const auto expect = [](const std::string& words, std::vector<std::array<GridAxis, 3>> pieces) {
        const std::vector<std::string> names{"a", "b", "c"};
        try {
            covered_cells(place_pieces(pieces, std::span(names).first(pieces.size()), "t.json"), names, "t.json");
            FAIL() << "nothing instead of " << words;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::data);
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
            EXPECT_NE(error.place().find("t.json"), std::string::npos);
            EXPECT_FALSE(error.advice().empty());
        }
    };
    const auto cube = [](double origin, double h, std::size_t n) {
        const GridAxis axis = uniform_axis(origin, h, n + 1);
        return std::array<GridAxis, 3>{axis, axis, axis};
    };
    expect("at least one piece", {});
    expect("piece b, axis x: expected planes among those", {cube(0, 1, 4), cube(0.7, 0.5, 2)});
    expect("piece b, axis x: expected a spacing that divides", {cube(0, 3, 4), cube(0, 2, 3), cube(0, 1, 1)});
    expect("piece b, axis x: expected planes where those of its level", {cube(0, 2, 2), cube(5, 2, 2), cube(1, 1, 1)});
    expect("an overlap with piece a in 3 .. 4, 3 .. 4, 3 .. 4", {cube(0, 1, 4), cube(3, 1, 2)});
    expect("piece a, cell 1: expected finer pieces that cover cells wholly", {cube(0, 2, 2), cube(0, 1, 3)});
    expect("whole multiple of the finest", {cube(0, 1, 4), cube(0, 0.4, 5)});
    expect("piece a, axis y: expected coordinates that ascend", {{uniform_axis(0, 1, 2), uniform_axis(0, -1, 2), uniform_axis(0, 1, 2)}});
    expect("piece a, axis z: expected at least 2 points", {{uniform_axis(0, 1, 2), uniform_axis(0, 1, 2), uniform_axis(0, 1, 1)}});
    expect("a spacing that is finite and not 0", {{uniform_axis(0, 1, 2), uniform_axis(0, 0, 2), uniform_axis(0, 1, 2)}});
    expect("one spacing", {{uniform_axis(0, 1, 2), GridAxis{{0, 1, 4}, {}}, uniform_axis(0, 1, 2)}});
    // What a level between covers is no part.
    const std::vector<std::string> names{"a", "b", "c"};
    const std::vector<std::array<GridAxis, 3>> nested{cube(0, 4, 2), cube(0, 2, 4), cube(2, 1, 4)};
    EXPECT_NO_THROW(covered_cells(place_pieces(nested, names, "t"), names, "t"));
    Grid points = block({0, 0, 0}, 1, {2, 2, 2}, [](const glm::dvec3&) { return 0.0; });
    Grid cells{points.axes, FieldLocation::cells, std::vector<double>(8, 0), {}};
    for (GridAxis& axis : cells.axes) axis = uniform_axis(2, 1, 3);
    EXPECT_THROW(make_grid_hierarchy({points, cells}, {"a", "b"}, "t"), Error);
}

// Every lattice cell is in the box of the finest piece there, or in none; and no box is behind one that a ray meets later.
TEST(HierarchyTree, BoxesPartThePiecesInAnExactOrder) {
    std::mt19937_64 random(71);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    for (int trial = 0; trial < 40; ++trial) {
        const GridHierarchy hierarchy = random_blocks(random, [](const glm::dvec3& p) { return p.x; });
        const Lattice& lattice = hierarchy.lattice;
        const HierarchyTree tree(lattice);
        double volume = 0;
        for (const HierarchyBox& box : tree.boxes())
            volume += static_cast<double>((box.box.high[0] - box.box.low[0]) * (box.box.high[1] - box.box.low[1]) * (box.box.high[2] - box.box.low[2]));
        double cells = 0;
        for (const PiecePlace& piece : lattice.pieces)
            if (piece.level == 0) cells += static_cast<double>((piece.box.high[0] - piece.box.low[0]) * (piece.box.high[1] - piece.box.low[1]) * (piece.box.high[2] - piece.box.low[2]));
        EXPECT_EQ(volume, cells);  // all lie in level 0
        const Bounds all = hierarchy.bounds();
        for (int i = 0; i < 200; ++i) {
            LatticeIndex cell{};
            for (std::size_t a = 0; a < 3; ++a) cell[a] = lattice.pieces[0].box.low[a] - 2 + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(lattice.pieces[0].box.high[a] + 4));
            int finest = -1;
            std::size_t owner = 0;
            for (std::size_t p = 0; p < lattice.pieces.size(); ++p) {
                const PiecePlace& piece = lattice.pieces[p];
                bool inside = piece.level > finest;
                for (std::size_t a = 0; a < 3; ++a) inside = inside && cell[a] >= piece.box.low[a] && cell[a] < piece.box.high[a];
                if (!inside) continue;
                finest = piece.level;
                owner = p;
            }
            const auto box = tree.box_at(cell);
            ASSERT_EQ(box.has_value(), finest >= 0);
            if (box) {
                EXPECT_EQ(tree.boxes()[*box].piece, owner);
            }
        }
        for (int i = 0; i < 20; ++i) {
            const glm::dvec3 origin = all.center() + 1.5 * glm::dvec3(both(random), both(random), both(random));  // inside, too
            const glm::dvec3 towards = all.low + glm::dvec3(unit(random), unit(random), unit(random)) * (all.high - all.low);
            const bool parallel = i % 2 == 0;
            const glm::dvec3 direction = glm::normalize(towards - origin);
            const std::vector<std::size_t> order = tree.front_to_back(parallel ? Eye::towards(-direction) : Eye::at(origin));
            ASSERT_EQ(order.size(), tree.boxes().size());
            double last = parallel ? -1e300 : 0;
            for (const std::size_t b : order) {
                double enter = parallel ? -1e300 : 0, leave = 1e300;
                for (int a = 0; a < 3; ++a) {
                    const auto i_a = static_cast<std::size_t>(a);
                    const double low = (lattice.plane(i_a, tree.boxes()[b].box.low[i_a]) - origin[a]) / direction[a];
                    const double high = (lattice.plane(i_a, tree.boxes()[b].box.high[i_a]) - origin[a]) / direction[a];
                    enter = std::max(enter, std::min(low, high));
                    leave = std::min(leave, std::max(low, high));
                }
                if (leave - enter < 1e-12) continue;  // not met, or at an edge
                EXPECT_GE(enter, last - 1e-12);
                last = leave;
            }
        }
    }
}

// The scalar of the cells that touch a place, each by its own piece.
std::vector<double> values_around(const GridHierarchy& hierarchy, const glm::dvec3& place) {
    std::vector<double> values;
    for (const Grid& piece : hierarchy.pieces) {
        const GridDimensions n = piece.dimensions();
        for (std::size_t k = 0; k + 1 < n.nk; ++k)
            for (std::size_t j = 0; j + 1 < n.nj; ++j)
                for (std::size_t i = 0; i + 1 < n.ni; ++i) {
                    const Bounds box = piece.cell_bounds({i, j, k});
                    const glm::dvec3 u = (place - box.low) / (box.high - box.low);
                    if (glm::any(glm::lessThan(u, glm::dvec3(-1e-9))) || glm::any(glm::greaterThan(u, glm::dvec3(1 + 1e-9)))) continue;
                    if (!piece.is_blanked({i, j, k})) values.push_back(interpolate(piece.corner_values({i, j, k}), u));
                }
        }
    return values;
}

TEST(GridHierarchy, TheScalarIsOneWhereLevelsMeet) {
    std::mt19937_64 random(72);
    std::uniform_real_distribution<double> unit(0, 1);
    int met = 0;
    for (int trial = 0; trial < 10; ++trial) {
        const GridHierarchy hierarchy = random_blocks(random, [&](const glm::dvec3&) { return unit(random); });
        for (const Grid& piece : hierarchy.pieces)
            for (int i = 0; i < 60; ++i) {
                const Bounds box = piece.bounds();
                glm::dvec3 place = box.low + glm::dvec3(unit(random), unit(random), unit(random)) * (box.high - box.low);
                const int axis = i % 3;
                place[axis] = i % 2 == 0 ? box.low[axis] : box.high[axis];
                const std::vector<double> around = values_around(hierarchy, place);
                if (around.size() < 2) continue;
                ++met;
                const auto [low, high] = std::minmax_element(around.begin(), around.end());
                EXPECT_NEAR(*low, *high, 1e-7);  // places are 1e-9 of a cell off at most, values below 1
            }
    }
    EXPECT_GT(met, 300);
}

TEST(GridHierarchy, ALinearFieldStaysAndCutCellsKeepTheirScalar) {
    std::mt19937_64 random(73);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto linear = [](const glm::dvec3& p) { return 1 + 2 * p.x - p.y + 0.5 * p.z; };
    std::size_t cut = 0;
    for (int trial = 0; trial < 10; ++trial) {
        const GridHierarchy hierarchy = random_blocks(random, linear);
        const HierarchyTree tree(hierarchy.lattice);
        for (const HierarchyBox& part : tree.boxes()) {
            const Grid grid = grid_in_box(hierarchy, part);
            validate(grid, "box");
            for (std::size_t a = 0; a < 3; ++a) cut += grid.axes[a].spacing ? 0U : 1U;
            for (int i = 0; i < 10; ++i) {
                GridCell cell{random() % grid.axes[0].cells(), random() % grid.axes[1].cells(), random() % grid.axes[2].cells()};
                const glm::dvec3 u(unit(random), unit(random), unit(random));
                const Bounds box = grid.cell_bounds(cell);
                EXPECT_NEAR(interpolate(grid.corner_values(cell), u), linear(box.low + u * (box.high - box.low)), 1e-13);
            }
        }
    }
    EXPECT_GT(cut, 0U);
}

// A coarse value that is none leaves its cells out, and takes nothing from the fine side.
TEST(GridHierarchy, MissingValuesAndCoveredPieces) {
    const auto one = [](const glm::dvec3&) { return 1.0; };
    Grid coarse = block({0, 0, 0}, 1, {4, 4, 4}, one);
    coarse.values[2 + 5 * (0 + 5 * 0)] = std::nan("");
    coarse.blanked.assign(64, 0);
    coarse.blanked[1] = coarse.blanked[2] = 1;
    const Grid fine = block({0, 0, 0}, 0.5, {4, 4, 4}, one);
    const GridHierarchy hierarchy = make_grid_hierarchy({coarse, fine}, {"c", "f"}, "t");
    EXPECT_EQ(hierarchy.visible_cells(), 64U - 8U - 1U + 64U);
    for (const double value : hierarchy.pieces[1].values) EXPECT_EQ(value, 1.0);
    const GridHierarchy whole = make_grid_hierarchy({block({0, 0, 0}, 1, {2, 2, 2}, one), fine}, {"c", "f"}, "t");
    EXPECT_EQ(whole.visible_cells(), 64U);
    EXPECT_EQ(HierarchyTree(whole.lattice).boxes().size(), 1U);
}

}  // namespace
}  // namespace cellproj
