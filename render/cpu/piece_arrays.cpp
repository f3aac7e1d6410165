// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/piece_arrays.hpp"

namespace cellproj::cpu {

PieceArrays::PieceArrays(const Method& method, const PieceTable& table, const WalkLimits& walk)
    : density(table.model == OpticalModel::density), count(static_cast<std::int32_t>(table.piece_count())), limits(walk), three_point_depth(method.kind == MethodKind::integral ? 0.125F : 0.0F),
      mean_place(density && method.kind == MethodKind::integral), bin_count(static_cast<float>(table.bin_count())) {
    for (std::size_t i = 0; i < table.piece_count(); ++i) {
        const float* texels = &table.pieces[4 * PieceTable::texels_per_piece * i];
        begin.push_back(texels[0]);
        end.push_back(texels[1]);
        inverse_width.push_back(1.0F / (texels[1] - texels[0]));
        for (std::size_t side = 0; side < 2; ++side) {
            extinction[side].push_back(texels[2 + side]);
            for (std::size_t channel = 0; channel < 3; ++channel) color[side][channel].push_back(texels[4 + 4 * side + channel]);
        }
        for (std::size_t channel = 0; channel < 4; ++channel) {
            running[channel].push_back(texels[12 + channel]);
            lost[channel].push_back(texels[16 + channel]);
        }
    }
    constexpr std::size_t longest_vector = 16;
    const std::size_t whole_vectors = (table.piece_count() + longest_vector - 1) / longest_vector * longest_vector;
    begin.resize(whole_vectors, 1e30F);  // behind all scalars, for who searches it by halving
    for (auto* list : {&end, &inverse_width, &extinction[0], &extinction[1]}) list->resize(whole_vectors);
    for (auto& of_side : color)
        for (auto& list : of_side) list.resize(whole_vectors);
    for (std::size_t channel = 0; channel < 4; ++channel) {
        running[channel].resize(whole_vectors);
        lost[channel].resize(whole_vectors);
    }
    for (std::size_t b = 0; b <= table.bin_count(); ++b) {
        first.push_back(static_cast<std::int32_t>(table.bins[4 * b]));
        last.push_back(static_cast<std::int32_t>(table.bins[4 * b + 1]));
    }
}

}  // namespace cellproj::cpu
