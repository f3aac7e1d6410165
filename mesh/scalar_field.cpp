// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/scalar_field.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

struct FoundField {
    const Field* field = nullptr;
    FieldLocation location = FieldLocation::points;
};

// All fields in the order of preference: point fields first.
std::vector<FoundField> all_fields(const TetMesh& mesh) {
    std::vector<FoundField> all;
    all.reserve(mesh.point_fields.size() + mesh.cell_fields.size());
    for (const Field& field : mesh.point_fields)
        all.push_back({&field, FieldLocation::points});
    for (const Field& field : mesh.cell_fields)
        all.push_back({&field, FieldLocation::cells});
    return all;
}

bool equal_ignoring_case(const std::string& a, const std::string& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

// The spelling under which `name` exists, or `name` itself. One spelling on points and on cells counts once.
std::string existing_spelling(const std::vector<FoundField>& all, const std::string& name) {
    std::set<std::string> spellings;
    for (const FoundField& found : all) {
        if (found.field->name == name) return name;
        if (equal_ignoring_case(found.field->name, name)) spellings.insert(found.field->name);
    }
    return spellings.size() == 1 ? *spellings.begin() : name;
}

std::string describe(const std::vector<FoundField>& all) {
    std::string list;
    for (const auto& [field, location] : all) {
        list += (list.empty() ? "\"" : ", \"") + field->name + "\" (";
        if (field->components != 1) list += std::to_string(field->components) + " components, ";
        list += location == FieldLocation::points ? "points)" : "cells)";
    }
    return list;
}

// Null where there is none.
const FoundField* find_field(const std::vector<FoundField>& all, const std::string& name) {
    const std::string spelling = existing_spelling(all, name);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const FoundField& one) { return one.field->name == spelling; });
    return found != all.end() ? &*found : nullptr;
}

[[noreturn]] void throw_unknown_field(const std::vector<FoundField>& all, const std::string& name,
                                      const std::string& place) {
    std::vector<std::string> names;
    for (const FoundField& one : all)
        names.push_back(one.field->name);
    throw Error({.kind = ErrorKind::option,
                 .place = place,
                 .expected = "one of the fields " + describe(all),
                 .found = "no field \"" + name + "\"",
                 .advice = "did you mean \"" + nearest_name(name, names) + "\"?"});
}

constexpr std::string_view axes = "xyz";

std::string component_name(int component, int components) {
    return components <= 3 ? std::string(1, axes[static_cast<std::size_t>(component)]) : std::to_string(component);
}

// "y" and "1" are 1. Throws Error (option) when the field has no such component.
int parse_component(const std::string& word, const Field& field, const std::string& place) {
    for (int component = 0; component < field.components; ++component) {
        const bool axis = component < 3 && word.size() == 1 && equal_ignoring_case(word, component_name(component, 3));
        if (axis || word == std::to_string(component)) return component;
    }
    const std::string last = std::to_string(field.components - 1);
    throw Error({.kind = ErrorKind::option,
                 .place = place,
                 .expected = "a component of \"" + field.name + "\": 0 to " + last + ", or x, y, z for the first three",
                 .found = "\"" + word + "\"",
                 .advice = "name the field alone for its magnitude"});
}

// "U", "U:z".
ScalarField scalar_by_name(const std::vector<FoundField>& all, const std::string& name, const std::string& place) {
    if (const FoundField* whole = find_field(all, name)) return as_scalar(*whole->field, whole->location);
    const std::size_t colon = name.rfind(':');
    if (colon == std::string::npos) throw_unknown_field(all, name, place);
    const FoundField* found = find_field(all, name.substr(0, colon));
    if (!found) throw_unknown_field(all, name.substr(0, colon), place);
    return as_scalar(*found->field, found->location, parse_component(name.substr(colon + 1), *found->field, place));
}

// "Points:z": coordinates go by the name that VTK has for them, where no field has it.
std::optional<ScalarField> coordinate_by_name(const TetMesh& mesh, const std::vector<FoundField>& all,
                                              const std::string& name, const std::string& place) {
    const std::size_t colon = name.rfind(':');
    if (colon == std::string::npos || !equal_ignoring_case(name.substr(0, colon), "Points")) return std::nullopt;
    if (find_field(all, name) || find_field(all, name.substr(0, colon))) return std::nullopt;
    Field places{"Points", 3, {}};
    places.values.reserve(3 * mesh.points.size());
    for (const glm::dvec3& p : mesh.points)
        places.values.insert(places.values.end(), {p.x, p.y, p.z});
    return as_scalar(places, FieldLocation::points, parse_component(name.substr(colon + 1), places, place));
}

FoundField default_field(const std::vector<FoundField>& all) {
    const auto scalar =
        std::find_if(all.begin(), all.end(), [](const FoundField& one) { return one.field->components == 1; });
    return scalar != all.end() ? *scalar : all.front();
}

// Root of the sum of squares of each row; a scalar stays as it is, with its sign.
std::vector<double> magnitudes(const Field& field) {
    assert(field.components >= 1);
    if (field.components == 1) return field.values;
    const auto components = static_cast<std::size_t>(field.components);
    std::vector<double> result(field.values.size() / components);
    for (std::size_t row = 0; row < result.size(); ++row) {
        double sum = 0.0;
        for (std::size_t i = 0; i < components; ++i) {
            const double value = field.values[row * components + i];
            sum += value * value;
        }
        result[row] = std::sqrt(sum);
    }
    return result;
}

bool varies(const std::vector<double>& values) {
    const ScalarRange r = range(values);
    return r.low < r.high;
}

// Whole numbers count or mark. The rows of points that were added to the file's are means of others and tell nothing.
bool whole_numbers(const FoundField& one, std::size_t added_points) {
    const std::size_t added = one.location == FieldLocation::points ? added_points : 0;
    const auto& values = one.field->values;
    const auto end = values.end() - static_cast<std::ptrdiff_t>(added * static_cast<std::size_t>(one.field->components));
    return std::all_of(values.begin(), end, [](double x) { return !std::isfinite(x) || x == std::floor(x); });
}

}  // namespace

std::optional<std::string> field_to_look_at(const TetMesh& mesh, std::size_t added_points) {
    const std::vector<FoundField> all = all_fields(mesh);
    std::optional<std::string> whole;
    for (const bool scalars : {true, false}) {
        for (const FoundField& one : all) {
            const Field& field = *one.field;
            if ((field.components == 1) != scalars) continue;
            // On cells under the name of a field on points: its name would draw that one.
            if (find_field(all, field.name)->field != &field) continue;
            if (!varies(scalars ? field.values : magnitudes(field))) continue;
            if (!whole_numbers(one, added_points)) return field.name;
            if (!whole) whole = field.name;
        }
    }
    return whole;
}

ScalarField select_scalar(const TetMesh& mesh, const std::string& name, const std::string& place, std::size_t added_points) {
    const std::vector<FoundField> all = all_fields(mesh);
    if (auto coordinate = coordinate_by_name(mesh, all, name, place)) return *std::move(coordinate);
    if (all.empty()) {
        throw Error({.kind = ErrorKind::data,
                     .place = place,
                     .expected = "at least one field on points or on cells",
                     .found = "none",
                     .advice = "write the file with the quantity that is to be drawn, or draw a coordinate: --field Points:z"});
    }
    if (!name.empty()) return scalar_by_name(all, name, place);
    if (const auto best = field_to_look_at(mesh, added_points)) return scalar_by_name(all, *best, place);
    const auto [field, location] = default_field(all);
    return as_scalar(*field, location);
}

ScalarField as_scalar(const Field& field, FieldLocation location) {
    return {field.name, location, magnitudes(field)};
}

ScalarField as_scalar(const Field& field, FieldLocation location, int component) {
    assert(component >= 0 && component < field.components);
    if (field.components == 1) return as_scalar(field, location);
    const auto components = static_cast<std::size_t>(field.components);
    ScalarField result{field.name + ":" + component_name(component, field.components), location, {}};
    result.values.reserve(field.values.size() / components);
    for (auto at = static_cast<std::size_t>(component); at < field.values.size(); at += components)
        result.values.push_back(field.values[at]);
    return result;
}

ScalarField averaged_to_points(const TetMesh& mesh, const ScalarField& field) {
    if (field.location == FieldLocation::points) return field;
    assert(field.values.size() == mesh.tets.size());
    std::vector<double> sums(mesh.points.size(), 0.0);
    std::vector<double> weights(mesh.points.size(), 0.0);
    for (CellId c = 0; c < mesh.tets.size(); ++c) {
        const double volume = std::abs(signed_volume(mesh, c));
        if (!(volume > 0.0)) continue;
        for (const VertexId v : mesh.tets[c]) {
            sums[v] += volume * field.values[c];
            weights[v] += volume;
        }
    }
    // Below 0: minus the number of flat cells around a point that has no others.
    for (CellId c = 0; c < mesh.tets.size(); ++c) {
        for (const VertexId v : mesh.tets[c]) {
            if (weights[v] > 0.0) continue;
            sums[v] -= field.values[c];
            weights[v] -= 1.0;
        }
    }
    ScalarField result{field.name, FieldLocation::points, std::move(sums)};
    for (std::size_t v = 0; v < result.values.size(); ++v)
        result.values[v] /= weights[v];  // 0 / 0, NaN, for points without cells
    return result;
}

ScalarField with_finite_values(ScalarField field, double value) {
    assert(std::isfinite(value));
    std::replace_if(
        field.values.begin(), field.values.end(), [](double v) { return !std::isfinite(v); }, value);
    return field;
}

ScalarRange range(const std::vector<double>& values) {
    ScalarRange result;
    bool first = true;
    for (const double value : values) {
        if (!std::isfinite(value)) {
            ++result.not_finite;
            continue;
        }
        result.low = first ? value : std::min(result.low, value);
        result.high = first ? value : std::max(result.high, value);
        first = false;
    }
    return result;
}

double quantile(const std::vector<double>& values, double share) {
    assert(share >= 0.0 && share <= 1.0);
    std::vector<double> finite;
    finite.reserve(values.size());
    std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
    if (finite.empty()) return 0.0;
    // Sorted, entry k has k values before it: the share k / #values.
    const auto before = static_cast<std::size_t>(share * static_cast<double>(finite.size()));
    const auto entry = finite.begin() + static_cast<std::ptrdiff_t>(std::min(before, finite.size() - 1));
    std::nth_element(finite.begin(), entry, finite.end());
    return *entry;
}

}  // namespace cellproj
