// SPDX-License-Identifier: BSD-3-Clause
//
// Local table updates, EKE01 §3.5: what changed, which pairs are computed, and that the result is that of a fresh table
// to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "classify/mean_tables.hpp"
#include "classify/preintegration_table.hpp"
#include "classify/transfer_change.hpp"

namespace cellproj {
namespace table_update_test {

using Colors = std::vector<ColorNode>;
using Extinctions = std::vector<ExtinctionNode>;

TransferFunction density(Colors colors, Extinctions extinctions) {
    return {OpticalModel::density, std::move(colors), std::move(extinctions)};
}

const Colors white{{0, {1, 1, 1}}};
const Extinctions hill{{0, 0}, {0.2, 1}, {0.4, 3}, {0.6, 2}, {0.8, 5}, {1, 0}};

Extinctions with(Extinctions nodes, std::size_t index, ExtinctionNode node) {
    nodes[index] = node;
    return nodes;
}

void expect_changed(const TransferFunction& a, const TransferFunction& b, double low, double high) {
    for (const auto& changed : {changed_scalars(a, b), changed_scalars(b, a)}) {
        ASSERT_TRUE(changed);
        EXPECT_EQ(changed->low, low);
        EXPECT_EQ(changed->high, high);
    }
}

TEST(ChangedScalars, LieBetweenTheUnchangedNeighbours) {
    const double infinity = std::numeric_limits<double>::infinity();
    const TransferFunction f = density(white, hill);
    EXPECT_FALSE(changed_scalars(f, f));
    expect_changed(f, density(white, with(hill, 2, {0.4, 4})), 0.2, 0.6);
    expect_changed(f, density(white, with(hill, 2, {0.5, 3})), 0.2, 0.6);
    expect_changed(f, density(white, with(hill, 0, {0, 1})), -infinity, 0.2);
    expect_changed(f, density(white, with(hill, 5, {1, 1})), 0.8, infinity);
    expect_changed(f, density({{0, {1, 1, 0}}}, hill), -infinity, infinity);

    Extinctions more = hill;
    more.insert(more.begin() + 3, {0.4, 0});  // a step
    expect_changed(f, density(white, more), 0.4, 0.6);
    more = hill;
    more.push_back({2, 7});
    expect_changed(f, density(white, more), 1, infinity);

    const Colors before{{0.1, {1, 0, 0}}, {0.3, {0, 1, 0}}, {0.5, {0, 0, 1}}},
        after{{0.1, {1, 0, 0}}, {0.3, {0, 1, 1}}, {0.5, {0, 0, 1}}};
    expect_changed(density(before, hill), density(after, with(hill, 3, {0.6, 1})), 0.1, 0.8);
}

TEST(ChangedScalars, AreAllWhereTheModelChanges) {
    const TransferFunction f = density(white, hill);
    const auto changed = changed_scalars(f, TransferFunction(OpticalModel::emitter, white, hill));
    ASSERT_TRUE(changed);
    EXPECT_TRUE(changed->meets(-1e9, -1e9) && changed->meets(1e9, 1e9));
    EXPECT_TRUE(changed_scalars(f, TransferFunction(OpticalModel::density, white, hill, Outside::transparent)));
}

constexpr int size = 18;

// Pairs of texels whose scalars meet the change, by looking at each.
std::size_t pairs_that_meet(const std::optional<ScalarInterval>& changed) {
    std::size_t count = 0;
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            count += changed && changed->meets(i / (size - 1.0), j / (size - 1.0)) ? 1 : 0;
    return count;
}

// `table` made of one function and updated to the next, through all of `functions`.
template <class Make>
void expect_updates_like_new(const std::vector<TransferFunction>& functions, Make make) {
    auto table = make(functions.front());
    for (std::size_t k = 1; k < functions.size(); ++k) {
        const auto fresh = make(functions[k]);
        const std::size_t computed = table.update(functions[k]);
        EXPECT_EQ(computed, pairs_that_meet(changed_scalars(functions[k - 1], functions[k]))) << k;
        EXPECT_EQ(table.texels(), fresh.texels()) << k;
        EXPECT_EQ(table.encoding().range(), fresh.encoding().range()) << k;
    }
}

// A function and random edits of it: nodes moved, changed, inserted (also as steps) and removed. The largest extinction
// stays: 9 at the last node.
std::vector<TransferFunction> edited_functions(OpticalModel model, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    Colors colors{{0, {0, 0, 1}}, {0.3, {0, 1, 0}}, {0.7, {1, 1, 0}}, {1, {1, 0, 0}}};
    Extinctions extinctions{{0, 0.5}, {0.25, 4}, {0.5, 0}, {0.75, 8}, {1, 9}};
    std::vector<TransferFunction> functions{{model, colors, extinctions}};
    const auto between = [&](const auto& nodes, std::size_t i) {
        return std::lerp(nodes[i - 1].scalar, nodes[i].scalar, unit(random));
    };
    for (int edit = 0; edit < 20; ++edit) {
        const auto i = std::uniform_int_distribution<std::size_t>(1, extinctions.size() - 2)(random);
        const auto at = extinctions.begin() + static_cast<std::ptrdiff_t>(i);
        switch (edit % 5) {
            case 0:
                extinctions.insert(at, {between(extinctions, i), 8 * unit(random)});
                break;
            case 1:
                at->extinction = 8 * unit(random);
                break;
            case 2:
                at->scalar = std::clamp(at->scalar + 0.01, extinctions[i - 1].scalar, extinctions[i + 1].scalar);
                break;
            case 3:
                colors[1].color.r = unit(random);
                break;
            default:
                if (extinctions.size() > 6) extinctions.erase(at);
        }
        for (std::size_t k = extinctions.size() - 1; k >= 2; --k)  // a clamped move may have made three of a step
            if (extinctions[k].scalar == extinctions[k - 2].scalar)
                extinctions.erase(extinctions.begin() + static_cast<std::ptrdiff_t>(k) - 1);
        functions.emplace_back(model, colors, extinctions);
    }
    return functions;
}

TEST(TableUpdate, GivesAFreshTableBitByBitFromTheAffectedPairsOnly) {
    for (const OpticalModel model : {OpticalModel::density, OpticalModel::emitter}) {
        const auto functions = edited_functions(model, 5);
        expect_updates_like_new(functions,
                                [](const auto& f) { return MeanValueTable(f, size, TableStorage::float32); });
        expect_updates_like_new(functions,
                                [](const auto& f) { return MeanLengthTable(f, 0.2, size, TableStorage::uint8); });
        expect_updates_like_new(functions, [](const auto& f) { return PreintegrationTable(f, {0, 1, 2}, size); });
        expect_updates_like_new(functions, [](const auto& f) {
            return PreintegrationTable(f, {0, 1, 2}, size, TableScale::linear, TableStorage::float16);
        });
    }
}

// Far more nodes than texels, and a node of 1e9 before the change, which running integrals would carry into all that
// follows.
TEST(TableUpdate, DoesNotDependOnWhatLiesBeside) {
    Extinctions comb{{0, 1e9}};
    for (int i = 1; i < 3000; ++i)
        comb.push_back({i / 2999.0, i % 2 == 0 ? 0.1 : 7.0});
    const std::vector<TransferFunction> functions{density(white, comb),
                                                  density(white, with(comb, 1500, {comb[1500].scalar, 6}))};
    expect_updates_like_new(functions, [](const auto& f) { return MeanValueTable(f, size, TableStorage::float32); });
    expect_updates_like_new(functions,
                            [](const auto& f) { return MeanLengthTable(f, 0.2, size, TableStorage::float32); });
    expect_updates_like_new(functions, [](const auto& f) { return PreintegrationTable(f, {0, 1, 2}, size); });
}

// The value at a step is that of its right side: a change of it belongs to the texel on the step.
TEST(TableUpdate, StepsOnTexelsBelongToTheChange) {
    const double on_texel = 5.0 / (size - 1), behind = 9.0 / (size - 1);
    const auto step = [&](double left, double right) {
        return density(white, {{0, 1}, {on_texel, left}, {on_texel, right}, {behind, 1}, {1, 9}});
    };
    const std::vector<TransferFunction> functions{step(2, 4), step(2, 6), step(3, 6), step(3, 3)};
    expect_updates_like_new(functions, [](const auto& f) { return MeanValueTable(f, size, TableStorage::float32); });
    expect_updates_like_new(functions,
                            [](const auto& f) { return MeanLengthTable(f, 0.2, size, TableStorage::float32); });
    expect_updates_like_new(functions, [](const auto& f) { return PreintegrationTable(f, {0, 1, 2}, size); });
}

// EKE01 §3.5: a change at one scalar touches the pairs that enclose it, at most half of the table, least near its ends.
TEST(TableUpdate, ALocalChangeComputesAtMostHalfOfTheTable) {
    Extinctions fine;
    for (int i = 0; i <= 100; ++i)
        fine.push_back({i / 100.0, 1.0 + i % 3});
    constexpr int large = 200;
    MeanValueTable table(density(white, fine), large, TableStorage::float32);
    for (const std::size_t node : {2U, 25U, 50U, 98U}) {
        Extinctions changed = fine;
        changed[node].extinction = 2.5;
        const double share = static_cast<double>(table.update(density(white, changed))) / (large * large);
        const double s = static_cast<double>(node) / 100;
        // 2s(1 − s), and the width of the change: .02, plus one texel at each side.
        EXPECT_NEAR(share, 2 * s * (1 - s), 2 * (0.02 + 2.0 / large)) << node;
        EXPECT_GT(share, 0) << node;
        table.update(density(white, fine));
    }
}

TEST(TableUpdate, TheLogarithmicScaleIsMadeAnewWithAnotherLargestExtinction) {
    PreintegrationTable table(density(white, hill), {0, 1, 2}, size);
    const TransferFunction higher = density(white, with(hill, 4, {0.8, 6}));
    EXPECT_EQ(table.update(higher), static_cast<std::size_t>(size * size));
    EXPECT_EQ(table.texels(), PreintegrationTable(higher, {0, 1, 2}, size).texels());
    EXPECT_EQ(table.update(higher), 0U);
}

}  // namespace
}  // namespace cellproj
