// SPDX-License-Identifier: BSD-3-Clause
#include "option_text.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

namespace cellproj::cli {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

std::optional<double> to_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0.0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<glm::dvec3> to_point(std::string_view text) {
    const auto words = split(text, ',');
    if (words.size() != 3) return std::nullopt;
    glm::dvec3 point;
    for (int axis = 0; axis < 3; ++axis) {
        const auto number = to_number(words[static_cast<std::size_t>(axis)]);
        if (!number) return std::nullopt;
        point[axis] = *number;
    }
    return point;
}

}  // namespace cellproj::cli
