// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers and points inside the words of options.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace cellproj::cli {

// At least one part; parts may be empty.
std::vector<std::string_view> split(std::string_view text, char separator);

// The whole word as a finite number.
std::optional<double> to_number(std::string_view word);

// X,Y,Z
std::optional<glm::dvec3> to_point(std::string_view text);

}  // namespace cellproj::cli
