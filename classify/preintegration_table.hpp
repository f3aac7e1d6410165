// SPDX-License-Identifier: BSD-3-Clause
//
// The pre-integration table over (s_f, s_b, l): RKE00 §3, EKE01 Eq. 5–7, with self-attenuation.
//
// RKE00 stores colour and opacity themselves, on a linear scale of l up to the mesh's longest edge. Then cells much
// thinner than that edge fall into the first texel, and one huge cell spoils the whole picture. We store what varies
// slowly with l instead:
//
//   τ̄(s_f, s_b)      mean extinction [1 / length], exact; opacity is then exact in l:  α = 1 − exp(−τ̄ l)
//   g(s_f, s_b, l)   effective emission [radiance / length]:                          colour = g · l · φ(τ̄ l)
//
// with φ(D) = (1 − e^(−D))/D. g runs from the mean emission (D → 0) to κ(s_f)·τ̄ (D → ∞, density model) and is tabulated
// on a logarithmic scale of l, u(l) = ln(1 + l/l₀) / ln(1 + l_max/l₀), so one table serves cells over any range of
// sizes.
//
// l₀ = min(1/τ_max, l_max), τ_max the largest extinction of the domain. Below l₀ no segment has an optical depth of 1,
// and u may be linear in l; above it u is linear in ln l, so that D = 0.1 .. 30 is equally well resolved for every τ̄ ≤
// τ_max.
//
// RKE00's own form is there as well (TableScale::linear): texels hold colour and opacity, evenly spaced in l from 0 to
// l_max, l₀ is not used, and a segment's light is what the interpolation gives. And so is storage in fewer bits
// (table_encoding.hpp).
//
// Texels are computed as float32: q, τ and their reciprocals should lie well inside 1e±38. The caller chooses the unit
// of length accordingly, best so that the mesh has a size of about 1. A value above the largest float32 is stored as
// that one, never as infinity.
//
// Accuracy is limited by the trilinear interpolation: classify/README.md, measured by
// tests/preintegration_table_test.cpp. Details of the transfer function that are narrower than a texel are blurred in
// the scalar; more texels, or integrate_segment, resolve them.
#pragma once

#include <cstddef>
#include <vector>

#include "classify/method.hpp"
#include "classify/table_encoding.hpp"
#include "classify/transfer_change.hpp"
#include "classify/transfer_function.hpp"

namespace cellproj {

struct TableDomain {
    double scalar_low;   // s of the first texel
    double scalar_high;  // s of the last texel; equal to scalar_low for a constant field
    double max_length;   // longest segment that will be looked up [mesh units], > 0
};

// Texel (i, j, k) — i: s_f, j: s_b, k: l — is at texels[4·(i + n·(j + n·k))]: (g.r, g.g, g.b, τ̄) on the logarithmic
// scale, (C.r, C.g, C.b, α) on the linear one, float32.
class PreintegrationTable {
public:
    // size n: 2 .. 512 texels per axis. Runs on all cores; the same texels whatever their number. Time grows with n³
    // and with the nodes between two scalars, up to 128 of them: above, neighbours are merged into their mean.
    PreintegrationTable(const TransferFunction& transfer, const TableDomain& domain, int size = 64,
                        TableScale scale = TableScale::logarithmic, TableStorage storage = TableStorage::float32);

    // Makes it the table of another function, the same to the last bit as if made anew. Only the pairs (s_f, s_b) with
    // changed scalars between them are computed (EKE01 §3.5), all n² where l₀ changes with the largest extinction.
    // Returns their number.
    std::size_t update(const TransferFunction& transfer);

    int size() const { return size_; }
    TableScale scale() const { return scale_; }
    const TableDomain& domain() const { return domain_; }
    double length_scale() const { return length_scale_; }  // l₀ [mesh units]
    const std::vector<float>& texels() const { return texels_; }
    const TableEncoding& encoding() const { return encoding_; }

    // What the renderer computes, in float64 from the stored texels: trilinear lookup, then α and colour as above.
    // s_f, s_b are clamped to the domain, l to 0 .. max_length; none may be NaN.
    Light lookup(double s_f, double s_b, double length) const;

private:
    std::size_t fill(const ScalarInterval& changed);

    TransferFunction transfer_;
    int size_;
    TableDomain domain_;
    TableScale scale_;
    double length_scale_;
    std::vector<float> texels_;
    TableEncoding encoding_;
};

}  // namespace cellproj
