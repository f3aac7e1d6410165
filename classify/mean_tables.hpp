// SPDX-License-Identifier: BSD-3-Clause
//
// The two tables over (s_f, s_b) alone, scalars 0..1 at n × n texels: colour and opacity at one length (RKE00 §4), and
// mean emission and extinction (EKE01 §3.3). n: 2 .. 4096. Both are computed on all cores, the same texels whatever
// their number; update() makes them the table of another function, the same to the last bit as if made anew, computes
// only the pairs with changed scalars between them (EKE01 §3.5) and returns their number. None is NaN or infinite.
#pragma once

#include <cstddef>
#include <vector>

#include "classify/method.hpp"
#include "classify/table_encoding.hpp"
#include "classify/transfer_change.hpp"
#include "classify/transfer_function.hpp"

namespace cellproj {

// RKE00 §4: associated colour C and opacity α of a segment of the mean length l̄, with self-attenuation; a segment of
// length l gets l/l̄ times as much of both. Where that would make the opacity exceed 1, the factor is 1/α. The texels
// keep to 0 .. range (table_encoding.hpp), the largest opacity becoming 1 before the multiplication: no channel
// saturates before. Right at l = l̄ and, to first order, in thin segments while τ̄·l̄ is small; wrong by up to the whole
// opacity else.
class MeanLengthTable {
public:
    // mean_length: l̄ > 0. Time grows with n² and with the nodes between two scalars.
    MeanLengthTable(const TransferFunction& transfer, double mean_length, int size, TableStorage storage);

    std::size_t update(const TransferFunction& transfer);

    int size() const { return size_; }
    double mean_length() const { return mean_length_; }
    const std::vector<float>& texels() const { return texels_; }  // (i, j) at 4·(i + n·j): C, α
    const TableEncoding& encoding() const { return encoding_; }
    Light lookup(double s_f, double s_b, double length) const;

private:
    std::size_t fill(const ScalarInterval& changed);

    TransferFunction transfer_;
    double mean_length_;
    int size_;
    std::vector<float> texels_;
    TableEncoding encoding_;
};

// EKE01 Eq. 8–10: means of emission and extinction between s_f and s_b by the integral of both over s. They are kept as
// means, so that opacity is exact in l, and where EKE01 takes ∫ q for the colour, without any attenuation, we attenuate
// it as in a homogeneous segment of these means: else it would grow without limit.
class MeanValueTable {
public:
    // Time grows with n² and with the nodes of the function, not with their product.
    MeanValueTable(const TransferFunction& transfer, int size, TableStorage storage);

    std::size_t update(const TransferFunction& transfer);

    int size() const { return size_; }
    const std::vector<float>& texels() const { return texels_; }  // (i, j) at 4·(i + n·j): q̄, τ̄
    const TableEncoding& encoding() const { return encoding_; }
    Light lookup(double s_f, double s_b, double length) const;

private:
    std::size_t fill(const ScalarInterval& changed);

    TransferFunction transfer_;
    int size_;
    std::vector<glm::dvec4> between_;  // means of (q, τ) from each texel to the next one
    std::vector<float> texels_;
    TableEncoding encoding_;
};

}  // namespace cellproj
