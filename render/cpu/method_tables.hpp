// SPDX-License-Identifier: BSD-3-Clause
//
// What the methods without pieces look up (classify/sampled_function.hpp, mean_tables.hpp, preintegration_table.hpp), as SIMD
// reads it: one array of float32 texels.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "classify/mean_tables.hpp"
#include "classify/method.hpp"
#include "classify/preintegration_table.hpp"
#include "classify/sampled_function.hpp"

namespace cellproj::cpu {

class MethodTables {
public:
    // How texels become light. The first four read samples of the transfer function along the segment.
    enum class Form {
        average,      // WVG91 Eq. 9–10
        homogeneous,  // WVG91, exponential
        stein,        // chromaticity, made opaque
        steps,        // WVG91, exponential linear: `steps` homogeneous ones
        mean_length,  // (s_f, s_b): light at the mean length
        mean_value,   // (s_f, s_b): mean emission and extinction
        effective,    // (s_f, s_b, ln l): effective emission and mean extinction
        light         // (s_f, s_b, l): the light itself
    };

    // Any method that finds light per pixel but `integral` and `exact`; `transfer` and lengths in scene units.
    MethodTables(const Method& method, const TransferFunction& transfer, double max_length, double mean_length);
    // The same method for another function; tables are updated where it differs.
    void set_transfer(const TransferFunction& transfer);
    MethodTables(const MethodTables&) = delete;
    MethodTables& operator=(const MethodTables&) = delete;

    Form form;
    int size = SampledFunction::size;      // texels per axis
    int steps = 1;
    float per_length = 1;                  // mean_length: 1/l̄; effective: 1/l₀; light: 1/longest
    float per_log_range = 1;               // effective: 1/ln(1 + longest/l₀)
    float longest;                         // longer segments count as this long
    const float* texels = nullptr;         // size, size² or size³ of (r, g, b, τ or α), the first axis fastest
    std::size_t bytes = 0;                 // of the tables in the storage that was asked for

private:
    void read_table();

    Method method_;
    std::variant<SampledFunction, MeanLengthTable, MeanValueTable, PreintegrationTable> table_;
    std::vector<float> decoded_;  // of storage in fewer bits, what it tells
};

}  // namespace cellproj::cpu
