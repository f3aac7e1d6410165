// SPDX-License-Identifier: BSD-3-Clause
#include "option_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace cellproj::cli {

namespace {

constexpr std::array<std::pair<std::string_view, glm::dvec3>, 12> names{{{"white", {1, 1, 1}},
                                                                         {"gray", {0.5, 0.5, 0.5}},
                                                                         {"black", {0, 0, 0}},
                                                                         {"red", {0.85, 0.1, 0.1}},
                                                                         {"orange", {1, 0.55, 0}},
                                                                         {"yellow", {0.95, 0.85, 0.1}},
                                                                         {"green", {0.1, 0.6, 0.2}},
                                                                         {"cyan", {0, 0.75, 0.75}},
                                                                         {"blue", {0.1, 0.3, 0.85}},
                                                                         {"purple", {0.5, 0.2, 0.7}},
                                                                         {"pink", {1, 0.55, 0.7}},
                                                                         {"brown", {0.55, 0.35, 0.2}}}};
// #RRGGBB
std::optional<glm::dvec3> to_hex_color(std::string_view text) {
    unsigned bits = 0;
    const auto [rest, error] = std::from_chars(text.data() + 1, text.data() + text.size(), bits, 16);
    if (text.size() != 7 || error != std::errc() || rest != text.data() + text.size()) return std::nullopt;
    return glm::dvec3(bits >> 16, bits >> 8 & 255U, bits & 255U) / 255.0;
}

}  // namespace

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

std::optional<std::vector<double>> to_numbers(std::string_view text, std::size_t count) {
    const auto words = split(text, ',');
    if (words.size() != count) return std::nullopt;
    std::vector<double> numbers;
    for (const std::string_view word : words) {
        const auto number = to_number(word);
        if (!number) return std::nullopt;
        numbers.push_back(*number);
    }
    return numbers;
}

std::optional<glm::dvec3> to_point(std::string_view text) {
    const auto numbers = to_numbers(text, 3);
    if (!numbers) return std::nullopt;
    return glm::dvec3((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

std::optional<glm::dvec3> to_color(std::string_view text) {
    if (text.starts_with('#')) return to_hex_color(text);
    const auto* name = std::ranges::find(names, text, [](const auto& entry) { return entry.first; });
    if (name != names.end()) return name->second;
    const auto numbers = to_point(text);
    if (!numbers || std::min({numbers->x, numbers->y, numbers->z}) < 0 || std::max({numbers->x, numbers->y, numbers->z}) > 1)
        return std::nullopt;
    return numbers;
}

}  // namespace cellproj::cli
