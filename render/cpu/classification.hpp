// SPDX-License-Identifier: BSD-3-Clause
//
// A method as the kernels want it: its tables for one transfer function, and what they let hide. Private to render/cpu.
#pragma once

#include <cstddef>
#include <optional>

#include "classify/method.hpp"
#include "classify/transfer_function.hpp"
#include "render/cpu/kernels.hpp"
#include "render/cpu/method_tables.hpp"
#include "render/cpu/piece_arrays.hpp"

namespace cellproj::cpu {

// In scene units, where half the diagonal of the mesh's box is 1: no segment is longer than the diagonal.
inline constexpr double longest_segment = 2.0;

class Classification {
public:
    // `transfer` and the mean length of a segment in scene units.
    Classification(const Method& method, const TransferFunction& transfer, double mean_length);
    Classification(const Classification&) = delete;
    Classification& operator=(const Classification&) = delete;

    void set_transfer(const TransferFunction& transfer);

    const Shading& shading() const { return shading_; }
    std::size_t bytes() const { return bytes_; }
    // Whether a ray can become opaque at all: along the whole diagonal, through the largest extinction.
    bool may_be_opaque() const { return may_be_opaque_; }

private:
    bool by_pieces() const { return method_.kind == MethodKind::integral || method_.kind == MethodKind::exact; }

    Method method_;
    std::optional<PieceArrays> pieces_;
    std::optional<MethodTables> tables_;
    Shading shading_;
    std::size_t bytes_ = 0;
    bool may_be_opaque_ = false;
};

}  // namespace cellproj::cpu
