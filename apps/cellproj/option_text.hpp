// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers, points and colours inside the words of options.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace cellproj::cli {

// At least one part; parts may be empty.
std::vector<std::string_view> split(std::string_view text, char separator);

// The whole word as a finite number.
std::optional<double> to_number(std::string_view word);

// As many finite numbers with commas between.
std::optional<std::vector<double>> to_numbers(std::string_view text, std::size_t count);

// X,Y,Z
std::optional<glm::dvec3> to_point(std::string_view text);

// What to_color understands, in words.
inline constexpr const char* color_forms =
    "white, gray, black, red, orange, yellow, green, cyan, blue, purple, pink, brown, #RRGGBB, or R,G,B in 0..1";
std::optional<glm::dvec3> to_color(std::string_view text);

}  // namespace cellproj::cli
