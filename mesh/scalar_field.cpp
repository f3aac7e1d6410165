// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/scalar_field.hpp"

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

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

FoundField find_field(const std::vector<FoundField>& all, const std::string& name, const std::string& place) {
    const std::string spelling = existing_spelling(all, name);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const FoundField& one) { return one.field->name == spelling; });
    if (found != all.end()) return *found;
    std::vector<std::string> names;
    for (const FoundField& one : all)
        names.push_back(one.field->name);
    throw Error({.kind = ErrorKind::option,
                 .place = place,
                 .expected = "one of the fields " + describe(all),
                 .found = "no field \"" + name + "\"",
                 .advice = "did you mean \"" + nearest_name(name, names) + "\"?"});
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

}  // namespace

ScalarField select_scalar(const TetMesh& mesh, const std::string& name, const std::string& place) {
    const std::vector<FoundField> all = all_fields(mesh);
    if (all.empty()) {
        throw Error({.kind = ErrorKind::data,
                     .place = place,
                     .expected = "at least one field on points or on cells",
                     .found = "none",
                     .advice = "write the file with the quantity that is to be drawn"});
    }
    const auto [field, location] = name.empty() ? default_field(all) : find_field(all, name, place);
    return as_scalar(*field, location);
}

ScalarField as_scalar(const Field& field, FieldLocation location) {
    return {field.name, location, magnitudes(field)};
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
