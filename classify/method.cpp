// SPDX-License-Identifier: BSD-3-Clause
#include "classify/method.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

// What a method is called and which choices it has.
struct Row {
    MethodKind kind;
    const char* name;
    int least_size, default_size, most_size;  // 0: no size
    bool has_tolerance, has_scale, has_storage, has_interpolation, has_blending;
};

constexpr std::array<Row, 10> rows{{
    {MethodKind::shirley_tuchman, "shirley-tuchman", 0, 0, 0, false, false, false, false, false},
    {MethodKind::average, "average", 0, 0, 0, false, false, false, true, true},
    {MethodKind::homogeneous, "homogeneous", 0, 0, 0, false, false, false, true, false},
    {MethodKind::linear, "linear", 1, 8, 1000, false, false, false, true, false},
    {MethodKind::stein, "stein", 0, 0, 0, false, false, false, false, false},
    {MethodKind::preint2d, "preint2d", 2, 256, 4096, false, false, true, false, false},
    {MethodKind::preint2d_exp, "preint2d-exp", 2, 256, 4096, false, false, true, false, false},
    {MethodKind::preint3d, "preint3d", 2, 64, 256, false, true, true, false, false},
    {MethodKind::integral, "integral", 0, 0, 0, false, false, false, false, false},
    {MethodKind::exact, "exact", 0, 0, 0, true, false, false, false, false},
}};

const Row& row_of(MethodKind kind) {
    return *std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.kind == kind; });
}

template <class Value>
struct Word {
    const char* text;
    Value value;
};
constexpr std::array<Word<TableScale>, 2> scales{{{"linear", TableScale::linear}, {"log", TableScale::logarithmic}}};
constexpr std::array<Word<TableStorage>, 3> storages{
    {{"uint8", TableStorage::uint8}, {"float16", TableStorage::float16}, {"float32", TableStorage::float32}}};
constexpr std::array<Word<Interpolation>, 2> interpolations{
    {{"pixels", Interpolation::pixels}, {"vertices", Interpolation::vertices}}};
constexpr std::array<Word<Blending>, 2> blendings{{{"once", Blending::once}, {"half", Blending::half}}};

template <class Words, class Value>
bool set_if_known(const Words& words, bool allowed, std::string_view part, Value& value) {
    for (const auto& word : words) {
        if (!allowed || part != word.text) continue;
        value = word.value;
        return true;
    }
    return false;
}

template <class Words, class Value>
const char* text_of(const Words& words, Value value) {
    return std::find_if(words.begin(), words.end(), [&](const auto& word) { return word.value == value; })->text;
}

std::vector<std::string> split(std::string_view text) {
    std::vector<std::string> parts(1);
    for (const char c : text) {
        if (c == ':') {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

template <class Number>
std::optional<Number> number_in(std::string_view part) {
    Number number{};
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    return error == std::errc() && end == part.data() + part.size() ? std::optional(number) : std::nullopt;
}

// What may follow the name, in words.
std::string choices(const Row& row) {
    std::vector<std::string> parts;
    if (row.most_size > 0)
        parts.push_back("a size from " + std::to_string(row.least_size) + " to " + std::to_string(row.most_size));
    if (row.has_tolerance) parts.push_back("a tolerance from 1e-9 to 0.1");
    if (row.has_scale) parts.push_back("linear or log");
    if (row.has_storage) parts.push_back("uint8, float16 or float32");
    if (row.has_interpolation) parts.push_back("pixels or vertices");
    if (row.has_blending) parts.push_back("once or half");
    std::string text;
    for (const std::string& part : parts)
        text += (text.empty() ? "" : "; ") + part;
    return text.empty() ? "nothing behind its name" : text;
}

bool set_size(const Row& row, std::string_view part, Method& method) {
    const std::optional<int> size = row.most_size > 0 ? number_in<int>(part) : std::nullopt;
    if (!size || *size < row.least_size || *size > row.most_size) return false;
    method.size = *size;
    return true;
}

bool set_tolerance(const Row& row, std::string_view part, Method& method) {
    const std::optional<double> tolerance = row.has_tolerance ? number_in<double>(part) : std::nullopt;
    if (!tolerance || !(*tolerance >= 1e-9 && *tolerance <= 0.1)) return false;
    method.tolerance = *tolerance;
    return true;
}

bool set_part(const Row& row, std::string_view part, Method& method) {
    return set_size(row, part, method) || set_tolerance(row, part, method) ||
           set_if_known(scales, row.has_scale, part, method.scale) ||
           set_if_known(storages, row.has_storage, part, method.storage) ||
           set_if_known(interpolations, row.has_interpolation, part, method.interpolation) ||
           set_if_known(blendings, row.has_blending, part, method.blending);
}

const Row& require_known(const std::string& name, const std::string& place) {
    std::vector<std::string> names;
    for (const Row& row : rows) {
        if (name == row.name) return row;
        names.emplace_back(row.name);
    }
    std::string list;
    for (const std::string& known : names)
        list += (list.empty() ? "" : ", ") + known;
    throw Error({ErrorKind::option, place, "one of " + list, name, "did you mean \"" + nearest_name(name, names) + "\"?"});
}

}  // namespace

Method parse_method(std::string_view text, const std::string& place) {
    const std::vector<std::string> parts = split(text);
    const Row& row = require_known(parts.front(), place);
    Method method{.kind = row.kind};
    if (row.most_size > 0) method.size = row.default_size;
    for (std::size_t i = 1; i < parts.size(); ++i) {
        if (set_part(row, parts[i], method)) continue;
        throw Error({ErrorKind::option, place + ", " + row.name, choices(row), "\"" + parts[i] + "\"", ""});
    }
    return method;
}

std::string to_string(const Method& method) {
    const Row& row = row_of(method.kind);
    const Method defaults;
    std::string text = row.name;
    if (row.most_size > 0) text += ":" + std::to_string(method.size);
    if (row.has_tolerance) {
        std::array<char, 32> number{};
        std::snprintf(number.data(), number.size(), "%g", method.tolerance);
        text += std::string(":") + number.data();
    }
    const auto add_choice = [&](bool has, const auto& words, auto value, auto usual) {
        if (has && value != usual) text += std::string(":") + text_of(words, value);
    };
    add_choice(row.has_scale, scales, method.scale, defaults.scale);
    add_choice(row.has_storage, storages, method.storage, defaults.storage);
    add_choice(row.has_interpolation, interpolations, method.interpolation, defaults.interpolation);
    add_choice(row.has_blending, blendings, method.blending, defaults.blending);
    return text;
}

}  // namespace cellproj
