// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/method_tables.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace cellproj::cpu {

namespace {

using Table = std::variant<SampledFunction, MeanLengthTable, MeanValueTable, PreintegrationTable>;
using Form = MethodTables::Form;

Form form_of(const Method& method, const TransferFunction& transfer) {
    switch (method.kind) {
        case MethodKind::average: return Form::average;
        case MethodKind::linear: return Form::steps;
        case MethodKind::preint2d: return Form::mean_length;
        case MethodKind::preint2d_exp: return Form::mean_value;
        case MethodKind::preint3d: return method.scale == TableScale::linear ? Form::light : Form::effective;
        // A chromaticity is what the density model is given by; without one `stein` is `homogeneous` (classify/sampled_methods.cpp).
        case MethodKind::stein: return transfer.model() == OpticalModel::density ? Form::stein : Form::homogeneous;
        default: return Form::homogeneous;
    }
}

SampledFunction samples(Form form, const TransferFunction& transfer) {
    return {transfer, form == Form::stein ? Sampled::color : Sampled::emission};
}

Table make_table(const Method& method, Form form, const TransferFunction& transfer, double max_length, double mean_length) {
    switch (form) {
        case Form::mean_length: return MeanLengthTable(transfer, mean_length, method.size, method.storage);
        case Form::mean_value: return MeanValueTable(transfer, method.size, method.storage);
        case Form::effective:
        case Form::light: return PreintegrationTable(transfer, {0.0, 1.0, max_length}, method.size, method.scale, method.storage);
        default: return samples(form, transfer);
    }
}

// Finite as float32, and so is its product with a length.
float bounded(double value) { return static_cast<float>(std::min(value, 1e30)); }

}  // namespace

MethodTables::MethodTables(const Method& method, const TransferFunction& transfer, double max_length, double mean_length)
    : form(form_of(method, transfer)),
      longest(static_cast<float>(max_length)),
      method_(method),
      table_(make_table(method, form, transfer, max_length, mean_length)) {
    if (method.kind == MethodKind::linear) steps = method.size;
    read_table();
}

void MethodTables::set_transfer(const TransferFunction& transfer) {
    form = form_of(method_, transfer);
    std::visit(
        [&](auto& table) {
            if constexpr (std::is_same_v<std::decay_t<decltype(table)>, SampledFunction>) {
                table = samples(form, transfer);
            } else {
                table.update(transfer);
            }
        },
        table_);
    read_table();
}

void MethodTables::read_table() {
    std::visit(
        [&](const auto& table) {
            using T = std::decay_t<decltype(table)>;
            texels = table.texels().data();
            bytes = table.texels().size() * sizeof(float);
            if constexpr (!std::is_same_v<T, SampledFunction>) {
                size = table.size();
                const TableEncoding& encoding = table.encoding();
                bytes = table.texels().size() / 4 * bytes_per_texel(encoding.storage());
                if (encoding.storage() != TableStorage::float32) {
                    decoded_.resize(table.texels().size());
                    for (std::size_t i = 0; i < decoded_.size(); i += 4) {
                        const glm::dvec4 value = encoding.value(texels + i);
                        for (int channel = 0; channel < 4; ++channel)
                            decoded_[i + static_cast<std::size_t>(channel)] = static_cast<float>(value[channel]);
                    }
                    texels = decoded_.data();
                }
            }
            if constexpr (std::is_same_v<T, MeanLengthTable>) per_length = bounded(1.0 / table.mean_length());
            if constexpr (std::is_same_v<T, PreintegrationTable>) {
                const double max_length = table.domain().max_length;
                per_length = bounded(1.0 / (table.scale() == TableScale::linear ? max_length : table.length_scale()));
                per_log_range = static_cast<float>(1.0 / std::log1p(max_length / table.length_scale()));
            }
        },
        table_);
}

}  // namespace cellproj::cpu
