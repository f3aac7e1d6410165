// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_sampling.hpp"

#include <array>
#include <charconv>
#include <optional>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

const std::array<std::string, 3> cuts{"cells", "object", "view"};     // in the order of the enumerations
const std::array<std::string, 3> lights{"segment", "post", "pre"};

std::optional<int> number(std::string_view text, int most) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > most) return std::nullopt;
    return value;
}

std::string_view take_part(std::string_view& rest) {
    const std::size_t colon = rest.find(':');
    const std::string_view part = rest.substr(0, colon);
    rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
    return part;
}

}  // namespace

GridSampling parse_grid_sampling(std::string_view text, const std::string& place) {
    const auto refuse = [&](const std::string& expected, std::string_view found, const std::string& advice) {
        throw Error({ErrorKind::option, place, expected, '"' + std::string(found) + '"', advice});
    };
    std::string_view rest = text;
    const std::string name(take_part(rest));
    GridSampling sampling;
    if (name == cuts[1]) sampling.cut = GridSampling::Cut::object;
    else if (name == cuts[2]) sampling.cut = GridSampling::Cut::view;
    else if (name != cuts[0]) refuse("cells, object:N or view:N", name, "did you mean \"" + nearest_name(name, cuts) + "\"?");
    if (sampling.cut == GridSampling::Cut::cells) {
        if (text != name) refuse("nothing behind cells", text, "ask for \"cells\" alone");
        return sampling;
    }
    const std::string_view count = take_part(rest);
    const auto slabs = number(count, 16384);
    if (!slabs) refuse("a number of slabs from 1 to 16384 behind " + name, count, "ask for \"" + name + ":128\"");
    sampling.slabs = *slabs;
    while (!rest.empty()) {
        const std::string_view part = take_part(rest);
        const auto several = part.starts_with('x') ? number(part.substr(1), 16) : std::nullopt;
        if (several) sampling.per_polygon = *several;
        else if (part == lights[1]) sampling.light = GridSampling::Light::post;
        else if (part == lights[2]) sampling.light = GridSampling::Light::pre;
        else refuse("post, pre or x1 to x16", part, "leave it out for pre-integrated slabs, one a polygon");
    }
    return sampling;
}

std::string to_string(const GridSampling& sampling) {
    std::string text = cuts[static_cast<std::size_t>(sampling.cut)];
    if (sampling.cut == GridSampling::Cut::cells) return text;
    text += ':' + std::to_string(sampling.slabs);
    if (sampling.light != GridSampling::Light::segment) text += ':' + lights[static_cast<std::size_t>(sampling.light)];
    if (sampling.per_polygon > 1) text += ":x" + std::to_string(sampling.per_polygon);
    return text;
}

}  // namespace cellproj
