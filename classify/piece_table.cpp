// SPDX-License-Identifier: BSD-3-Clause
#include "classify/piece_table.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>

namespace cellproj {

namespace {

constexpr double largest_value = 1e15;
constexpr std::size_t few_pieces = 64;

// The largest float32 that is not above s. Below 1e-30 it is 0: so widths of pieces are never denormal, which some drivers
// take for 0.
float rounded_down(double s) {
    if (s < 1e-30) return 0.0F;
    const float nearest = static_cast<float>(s);
    return nearest > s ? std::nextafter(nearest, 0.0F) : nearest;
}

float stored(double value) {
    return static_cast<float>(std::min(value, largest_value));
}

// A piece as the table holds it.
struct Piece {
    float begin, end;
    float extinction_begin, extinction_end;
    glm::vec3 color_begin, color_end;

    // ∫ q ds and ∫ τ ds over the piece: both are polynomials.
    glm::dvec4 integral(OpticalModel model) const {
        const double width = static_cast<double>(end) - begin;
        const glm::dvec3 c0 = color_begin, c1 = color_end;
        const double t0 = extinction_begin, t1 = extinction_end;
        const glm::dvec3 emission = model == OpticalModel::density
                                        ? (c0 * (2.0 * t0 + t1) + c1 * (t0 + 2.0 * t1)) / 6.0
                                        : (c0 + c1) / 2.0;
        return width * glm::dvec4(emission, (t0 + t1) / 2.0);
    }
};

glm::vec3 stored(const glm::dvec3& color) {
    return {stored(color.x), stored(color.y), stored(color.z)};
}

std::vector<Piece> pieces_of(const TransferFunction& transfer) {
    std::vector<Piece> pieces;
    for (const LinearPiece& piece : transfer.pieces()) {
        const double low = std::max(piece.begin, 0.0), high = std::min(piece.end, 1.0);
        if (low >= high) continue;
        const float begin = rounded_down(low), end = rounded_down(high);
        if (begin == end) continue;
        pieces.push_back({begin, end, stored(piece.extinction(low)), stored(piece.extinction(high)),
                          stored(piece.color(low)), stored(piece.color(high))});
    }
    const float extinction = stored(transfer.extinction(1.0));
    const glm::vec3 color = stored(transfer.color(1.0));
    pieces.push_back({1.0F, 2.0F, extinction, extinction, color, color});
    return pieces;
}

void append(std::vector<float>& texels, const glm::vec4& texel) {
    texels.insert(texels.end(), {texel.x, texel.y, texel.z, texel.w});
}

std::vector<float> make_bins(const std::vector<Piece>& pieces) {
    // Four bins a piece: most hold one node or none, and the piece is found without a search.
    const std::size_t count = std::bit_ceil(std::clamp<std::size_t>(4 * pieces.size(), 64, 16384));
    std::vector<float> bins;
    bins.reserve(4 * (count + 1));
    std::size_t first = 0;
    for (std::size_t b = 0; b <= count; ++b) {
        const double begin = static_cast<double>(b) / static_cast<double>(count);
        const double end = b == count ? 2.0 : static_cast<double>(b + 1) / static_cast<double>(count);
        while (first + 1 < pieces.size() && pieces[first + 1].begin <= begin)
            ++first;
        std::size_t last = first;
        while (last + 1 < pieces.size() && pieces[last + 1].begin < end)
            ++last;
        append(bins, {first, last, pieces[(first + last + 1) / 2].begin, 0.0F});
        first = last;
    }
    return bins;
}

// The brightest channel that light along a path of `max_length` can have, at least 1.
double brightest(const PieceTable& table, double max_length) {
    double largest = 0.0;
    for (std::size_t i = 0; i < table.piece_count(); ++i) {
        const glm::dvec4 color = glm::max(table.texel(i, 1), table.texel(i, 2));
        largest = std::max({largest, color.x, color.y, color.z});
    }
    return std::max(1.0, table.model == OpticalModel::emitter ? largest * max_length : largest);
}

}  // namespace

glm::dvec4 PieceTable::texel(std::size_t piece, std::size_t which) const {
    const float* values = &pieces[4 * (texels_per_piece * piece + which)];
    return {values[0], values[1], values[2], values[3]};
}

std::size_t PieceTable::piece_of(float s) const {
    assert(s >= 0.0F && s <= 1.0F);
    const float* bin = &bins[4 * static_cast<std::size_t>(s * static_cast<float>(bin_count()))];
    auto first = static_cast<std::size_t>(bin[0]), last = static_cast<std::size_t>(bin[1]);
    while (first < last) {
        const std::size_t middle = (first + last + 1) / 2;
        if (s < static_cast<float>(texel(middle, 0).x)) {
            last = middle - 1;
        } else {
            first = middle;
        }
    }
    return first;
}

PieceTable make_piece_table(const TransferFunction& transfer) {
    const std::vector<Piece> pieces = pieces_of(transfer);
    PieceTable table;
    table.model = transfer.model();
    table.pieces.reserve(pieces.size() * PieceTable::texels_per_piece * 4);
    glm::dvec4 running(0.0);
    for (const Piece& piece : pieces) {
        const glm::vec4 rounded(running);
        append(table.pieces, {piece.begin, piece.end, piece.extinction_begin, piece.extinction_end});
        append(table.pieces, {piece.color_begin, 0.0F});
        append(table.pieces, {piece.color_end, 0.0F});
        append(table.pieces, rounded);
        append(table.pieces, glm::vec4(running - glm::dvec4(rounded)));
        running += piece.integral(table.model);
    }
    table.bins = make_bins(pieces);
    return table;
}

WalkLimits walk_limits(const Method& method, const PieceTable& table, double max_length) {
    const double bright = brightest(table, max_length);
    // The mean colour of a block errs by up to D/8 of its light where the colour changes half-way (density), D/2 where all
    // emission lies before the extinction (emitter). Among few pieces, blocks save less than looking for them costs.
    const double block = table.model == OpticalModel::density ? 1.0 / 16.0 : 1.0 / 64.0;
    if (method.kind == MethodKind::integral)
        return {1.0, table.piece_count() > few_pieces ? block : 0.0, std::log(bright / 1e-6)};
    // The rule errs by 1.1e-5·D⁴ over a step of depth D (the largest over all linear τ, found by computing), so by 1.1e-5·D³
    // per depth; it and what lies deepest may cost a quarter of the tolerance each. Steps below 1/16 (3e-9) would only
    // add to the rounding of float32.
    const double share = method.tolerance / 4.0 / bright;
    return {std::clamp(std::cbrt(share / 1.1e-5), 1.0 / 16.0, 1.0), 0.0, -std::log(share)};
}

}  // namespace cellproj
