// SPDX-License-Identifier: BSD-3-Clause
//
// How a number lies in a binary file.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace cellproj {

enum class NumberType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct NamedNumberType {
    std::string_view name;
    NumberType type;
};
inline constexpr std::array<NamedNumberType, 8> number_types{{{"int8", NumberType::int8},
                                                              {"uint8", NumberType::uint8},
                                                              {"int16", NumberType::int16},
                                                              {"uint16", NumberType::uint16},
                                                              {"int32", NumberType::int32},
                                                              {"uint32", NumberType::uint32},
                                                              {"float32", NumberType::float32},
                                                              {"float64", NumberType::float64}}};

constexpr std::size_t bytes_of(NumberType type) {
    switch (type) {
        case NumberType::int8:
        case NumberType::uint8:
            return 1;
        case NumberType::int16:
        case NumberType::uint16:
            return 2;
        case NumberType::int32:
        case NumberType::uint32:
        case NumberType::float32:
            return 4;
        case NumberType::float64:
            break;
    }
    return 8;
}

}  // namespace cellproj
