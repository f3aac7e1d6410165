// SPDX-License-Identifier: BSD-3-Clause
//
// Tiles of the CPU backend: bins in slabs of any size, and tiles that are full.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "classify/piece_table.hpp"
#include "classify/segment_method.hpp"
#include "render/cpu/screen_mesh.hpp"
#include "render/cpu/tile_bins.hpp"
#include "render/image.hpp"
#include "render/prepared_scene.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace cpu_tiles_test {

using testing_support::constant_medium;
using testing_support::grid_mesh;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;

using Lists = std::map<std::pair<int, int>, std::vector<std::uint32_t>>;

class CpuTiles : public testing::Test {
protected:
    static constexpr ImageSize size{200, 150};
    static constexpr int columns = (size.width + cpu::tile_side - 1) / cpu::tile_side, rows = (size.height + cpu::tile_side - 1) / cpu::tile_side;
    static constexpr cpu::Region region{0, 0, size.width, size.height};

    explicit CpuTiles(double extinction = 100)
        : scene_(scene_of(grid_mesh(CELLPROJ_SANITIZED ? 26 : 40, 0.2), [](const glm::dvec3& p) { return p.x; }, constant_medium(extinction))),
          prepared_(scene_) {
        const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
        order_ = prepared_.order(camera, size, std::nullopt, nullptr);
        mesh_.set_scene(prepared_);
        mesh_.set_view(camera, size);
        items_ = mesh_.cut(order_);
    }

    // A slab's lists in front of what is there: slabs come from the front, lists go from back to front.
    static void add_lists(const cpu::TileBins& bins, Lists& lists) {
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x) {
                const auto items = bins.tile(x, y);
                auto& list = lists[{x, y}];
                list.insert(list.begin(), items.begin(), items.end());
            }
    }

    Scene scene_;
    PreparedScene prepared_;
    ViewOrder order_;
    cpu::ScreenMesh mesh_;
    std::span<const std::uint32_t> items_;
};

TEST_F(CpuTiles, AnyBudgetGivesTheSameLists) {
    Lists whole;
    cpu::TileBins at_once;
    at_once.begin(mesh_.cells(), region, items_, {}, true);
    ASSERT_TRUE(at_once.next_tiles());
    add_lists(at_once, whole);
    EXPECT_FALSE(at_once.next_tiles());
    EXPECT_GT(at_once.drawn(), items_.size() - 100);  // few meet no pixel centre
    for (const std::size_t budget : {std::size_t{1}, std::size_t{30000}, std::size_t{1} << 24})
        for (const bool by_tiles : {false, true}) {
            cpu::TileBins bins(budget);
            Lists lists;
            std::size_t slabs = 0;
            bins.begin(mesh_.cells(), region, items_, {}, true);
            while (by_tiles ? bins.next_tiles() : bins.next()) {
                add_lists(bins, lists);
                ++slabs;
                if (by_tiles && budget == 30000) {
                    std::size_t entries = 0, tiles = 0;
                    for (int y = 0; y < rows; ++y)
                        for (int x = 0; x < columns; ++x) {
                            entries += bins.tile(x, y).size();
                            tiles += !bins.tile(x, y).empty();
                        }
                    EXPECT_TRUE(entries <= budget || tiles == 1) << entries;
                }
            }
            EXPECT_TRUE(lists == whole) << budget;
            EXPECT_EQ(bins.drawn(), at_once.drawn());
            if (budget < 100) {
                EXPECT_GT(slabs, 1U);
            }
        }
}

TEST_F(CpuTiles, FullTilesTakeNoFurtherCells) {
    cpu::TileBins bins(1);
    bins.begin(mesh_.cells(), region, items_, {}, true);
    ASSERT_TRUE(bins.next());
    bins.full(3, 2) = 1;
    ASSERT_TRUE(bins.next());
    EXPECT_TRUE(bins.tile(3, 2).empty());
    EXPECT_FALSE(bins.tile(2, 2).empty());
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) bins.full(x, y) = 1;
    EXPECT_FALSE(bins.next());
    bins.begin(mesh_.cells(), region, items_, {}, true);  // a new picture begins with none
    ASSERT_TRUE(bins.next());
    EXPECT_FALSE(bins.tile(3, 2).empty());
}

// Against tiles that never close: what is left out may show 1e-4 of colours up to 1.
TEST_F(CpuTiles, WhatIsLeftOutBehindOpaqueTilesCannotBeSeen) {
    const SceneUnits& units = prepared_.units();
    const PieceTable table = make_piece_table(in_scene_units(*scene_.transfer, units.scalar_low, units.scalar_high, units.length));
    const cpu::PieceArrays pieces({}, table, walk_limits({}, table, 2.0));
    std::size_t entries[2] = {}, drawn[2];
    Image images[2]{{size.width, size.height}, {size.width, size.height}};
    for (const bool closes : {false, true}) {
        cpu::TileBins bins;
        bins.begin(mesh_.cells(), region, items_, {}, true);
        const cpu::Shading shading{.pieces = &pieces, .opaque = closes ? 0.9999F : 2.0F};
        while (bins.next())
            for (int row = 0; row < rows; ++row)
                for (int column = 0; column < columns; ++column) {
                    const int x = column * cpu::tile_side, y = row * cpu::tile_side;
                    const cpu::Tile tile{x, y, std::min(cpu::tile_side, size.width - x), std::min(cpu::tile_side, size.height - y),
                                         &images[closes].at(x, y), static_cast<std::size_t>(size.width), &bins.full(column, row)};
                    entries[closes] += bins.tile(column, row).size();
                    cpu::draw_tile(mesh_.cells(), shading, tile, bins.tile(column, row));
                }
        drawn[closes] = bins.drawn();
    }
    float largest = 0;
    for (std::size_t i = 0; i < images[0].pixels.size(); ++i)
        for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(images[0].pixels[i][k] - images[1].pixels[i][k]));
    EXPECT_LT(largest, 1.01e-4F);
    EXPECT_GT(drawn[0], items_.size() - 100);
    EXPECT_LT(drawn[1], drawn[0]);
    EXPECT_LT(entries[1], entries[0]);
}

}  // namespace
}  // namespace cellproj
