// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/error.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace cellproj {

namespace {

std::string message(const ErrorParts& parts) {
    std::string text = parts.place;
    if (!parts.expected.empty()) text += ": expected " + parts.expected;
    if (!parts.found.empty()) text += (parts.expected.empty() ? ": " : ", found ") + parts.found;
    if (!parts.advice.empty()) text += "; " + parts.advice;
    return text;
}

// Levenshtein distance, one row at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

Error::Error(ErrorParts parts) : std::runtime_error(message(parts)), parts_(std::move(parts)) {}

std::string nearest_name(std::string_view word, std::span<const std::string> known) {
    const auto nearest = std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
        return edit_distance(word, a) < edit_distance(word, b);
    });
    return nearest == known.end() ? std::string() : *nearest;
}

void require_known_keys(std::string_view place, std::span<const std::string> found,
                        std::span<const std::string> known) {
    for (const std::string& key : found) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        std::string list;
        for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
        throw Error({.kind = ErrorKind::option,
                     .place = std::string(place),
                     .expected = "one of the keys " + list,
                     .found = "the unknown key \"" + key + "\"",
                     .advice = "did you mean \"" + nearest_name(key, known) + "\"?"});
    }
}

}  // namespace cellproj
