// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/classification.hpp"

#include <algorithm>
#include <cmath>

#include "classify/piece_table.hpp"

namespace cellproj::cpu {

namespace {

// What may shine through before a pixel counts as opaque. Twenty times below a step of 8 bits where colours are at most 1.
constexpr double hidden_share = 1e-4;

}  // namespace

Classification::Classification(const Method& method, const TransferFunction& transfer, double mean_length) : method_(method) {
    if (!by_pieces()) tables_.emplace(method, transfer, longest_segment, mean_length);
    set_transfer(transfer);
}

void Classification::set_transfer(const TransferFunction& transfer) {
    shading_.half_opacity = method_.blending == Blending::half;
    double hidden = hidden_share;
    if (by_pieces()) {
        const PieceTable table = make_piece_table(transfer);
        const WalkLimits limits = walk_limits(method_, table, longest_segment);
        pieces_.emplace(method_, table, limits);
        bytes_ = table.bytes();
        shading_.pieces = &*pieces_;
        // `integral` looks down to 1e-6 in a segment, relative to the brightest colour.
        hidden = std::min(hidden, std::exp(-limits.deepest) * (method_.kind == MethodKind::integral ? 100.0 : 1.0));
    } else {
        tables_->set_transfer(transfer);
        bytes_ = tables_->bytes;
        shading_.tables = &*tables_;
    }
    may_be_opaque_ = transfer.max_extinction(0.0, 1.0) * longest_segment > -std::log(hidden);
    shading_.opaque = static_cast<float>(1.0 - hidden);
}

}  // namespace cellproj::cpu
