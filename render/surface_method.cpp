// SPDX-License-Identifier: BSD-3-Clause
#include "render/surface_method.hpp"

#include <charconv>
#include <optional>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

constexpr int smallest = 2, largest = 2048;

std::optional<SurfaceMethodKind> kind_of(std::string_view name) {
    if (name == "exact") return SurfaceMethodKind::exact;
    if (name == "table") return SurfaceMethodKind::table;
    if (name == "combined") return SurfaceMethodKind::combined;
    return std::nullopt;
}

}  // namespace

bool takes_surfaces(const Method& method) { return !light_at_vertices(method) && method.blending == Blending::once; }

SurfaceMethod parse_surface_method(std::string_view text, const std::string& place) {
    const auto colon = text.find(':');
    const auto kind = kind_of(text.substr(0, colon));
    const auto refuse = [&](const std::string& expected) {
        throw Error({ErrorKind::option, place, expected, "\"" + std::string(text) + "\"", "exact is the usual one"});
    };
    if (!kind) refuse("exact, table, table:N, combined or combined:N");
    SurfaceMethod method{.kind = *kind};
    if (colon == text.npos) return method;
    if (*kind == SurfaceMethodKind::exact) refuse("exact without a size");
    const char* end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data() + colon + 1, end, method.size);
    if (failure != std::errc() || stop != end || method.size < smallest || method.size > largest)
        refuse("a size of the table from " + std::to_string(smallest) + " to " + std::to_string(largest));
    return method;
}

std::string to_string(const SurfaceMethod& method) {
    switch (method.kind) {
        case SurfaceMethodKind::exact: break;
        case SurfaceMethodKind::table: return "table:" + std::to_string(method.size);
        case SurfaceMethodKind::combined: return "combined:" + std::to_string(method.size);
    }
    return "exact";
}

}  // namespace cellproj
