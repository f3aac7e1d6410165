// SPDX-License-Identifier: BSD-3-Clause
#include "iso_options.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "mesh/error.hpp"
#include "option_text.hpp"

namespace cellproj::cli {

namespace {

[[noreturn]] void refuse(const std::string& expected, std::string_view found, const std::string& advice) {
    throw Error({ErrorKind::option, "--iso", expected, "\"" + std::string(found) + "\"", advice});
}

// Emission of an emitter is per length: only its hue is a colour. What is black there says nothing about a surface.
glm::dvec3 color_at(const TransferFunction& colors, double value) {
    const glm::dvec3 color = colors.color(value);
    const double brightest = std::max({color.x, color.y, color.z});
    if (!(brightest > 0)) return glm::dvec3(0.8);
    return colors.model() == OpticalModel::emitter || brightest > 1 ? color / brightest : color;
}

void add_surfaces(std::string_view text, const TransferFunction& colors, std::vector<IsoSurface>& surfaces) {
    const auto parts = split(text, ':');
    if (parts.size() > 3) refuse("VALUE[,VALUE...][:COLOR[:OPACITY]]", text, "give --iso again for another colour");
    const bool colored = parts.size() > 1 && !parts[1].empty();
    const auto color = colored ? to_color(parts[1]) : std::nullopt;
    if (colored && !color) refuse(std::string("a colour: ") + color_forms, parts[1], "leave it empty for that of the transfer function");
    const auto opacity = parts.size() > 2 ? to_number(parts[2]) : 1.0;
    if (!opacity || *opacity < 0 || *opacity > 1) refuse("an opacity in 0..1", parts[2], "1 hides what is behind");
    for (const std::string_view word : split(parts[0], ',')) {
        const auto value = to_number(word);
        if (!value) refuse("isovalues: finite numbers with commas between", word, "info tells the range of every field");
        surfaces.push_back({*value, color.value_or(color_at(colors, *value)), *opacity, {}});
    }
}

DirectionalLight to_light(std::string_view text) {
    const auto refuse_light = [&](const std::string& expected, std::string_view found) {
        throw Error({ErrorKind::option, "--light", expected, "\"" + std::string(found) + "\"", "write X,Y,Z[:COLOR] or eye[:COLOR], and --light again for a second light"});
    };
    const auto parts = split(text, ':');
    if (parts.size() > 2) refuse_light("X,Y,Z[:COLOR] or eye[:COLOR]", text);
    DirectionalLight light;
    if (parts[0] != "eye") {
        light.towards = to_point(parts[0]);
        if (!light.towards) refuse_light("a direction, three finite numbers with commas between, or eye", parts[0]);
    }
    if (parts.size() > 1) {
        const auto color = to_color(parts[1]);
        if (!color) refuse_light(std::string("a colour: ") + color_forms, parts[1]);
        light.color = *color;
    }
    return light;
}

}  // namespace

const char* const iso_method_help =
    "How isosurfaces are found in a cell: exact, where the ray crosses them; table:N, all of a cell by one lookup in a table of N² scalars, and "
    "combined:N, likewise, part before and part behind the cell's medium: both approximate, for comparison (gl; render/README.md)";

void add_iso_options(CLI::App& command, IsoOptions& options) {
    command.add_option("--iso", options.surfaces,
                       std::string("Draw isosurfaces of --field: VALUE[,VALUE...][:COLOR[:OPACITY]] (again for more). COLOR: ") +
                           color_forms + "; default: that of the transfer function at the value. OPACITY: 0..1, default 1")
        ->allow_extra_args(false);
    command.add_flag("--volume", options.volume,
                     "Draw the volume around isosurfaces and slices, too; so do --transfer, --opacity-scale and --opacity-field");
    command.add_flag("--shade-volume", options.shade_volume,
                     "Light the volume by its gradient, as isosurfaces are by theirs; draws it around isosurfaces and slices, too");
    command.add_option("--shading", options.shading,
                       "Isosurfaces and --shade-volume: smooth (by the gradients of the points), flat (of the cells), or unlit: isosurfaces in their colour as it is")
        ->check(CLI::IsMember({"flat", "smooth", "unlit"}))->capture_default_str()
        ->each([&options](const std::string&) { options.shading_chosen = true; });
    command.add_option("--light", options.lights,
                       std::string("Isosurfaces, bodies and --shade-volume: towards a distant light, X,Y,Z[:COLOR], or the viewer's own, eye[:COLOR] (again for "
                                   "more; default: eye). COLOR: ") + color_forms + "; default white")
        ->allow_extra_args(false);
}

void require_something_in_volume(const IsoOptions& options, bool slices) {
    if (options.volume && !options.any() && !slices) throw CLI::ValidationError("--volume", "without --iso and --slice it is drawn anyway");
}

SurfaceScene parse_surfaces(const IsoOptions& options, const TransferFunction& colors) {
    std::vector<IsoSurface> surfaces;
    for (const std::string& text : options.surfaces) add_surfaces(text, colors, surfaces);
    SurfaceScene scene{.isosurfaces = IsoSurfaces(std::move(surfaces), "--iso"),
                       .shading = options.shading == "flat"    ? Shading::flat
                                  : options.shading == "unlit" ? Shading::unlit
                                                               : Shading::smooth};
    scene.lighting = parse_lighting(options);
    scene.lit_medium = options.shade_volume;
    return scene;
}

void require_shaded(const IsoOptions& options, bool bodies) {
    if (options.shade_volume && options.shading == "unlit") throw CLI::ExcludesError("--shade-volume", "--shading unlit");
    if (options.shading_chosen && !options.any_shaded()) throw CLI::RequiresError("--shading", "--iso or --shade-volume");
    if (!options.lights.empty() && !options.any_shaded() && !bodies)
        throw Error({ErrorKind::option, "--light", "isosurfaces, bodies or a volume to be lit", "none", "give --iso, --surface or --shade-volume"});
}

Lighting parse_lighting(const IsoOptions& options) {
    Lighting lighting;
    if (!options.lights.empty()) lighting.lights.clear();
    for (const std::string& text : options.lights) lighting.lights.push_back(to_light(text));
    validate(lighting, "--light");
    return lighting;
}

void warn_of_missing(const IsoSurfaces& surfaces, const ScalarField& field) {
    const ScalarRange values = range(field.values);
    for (const IsoSurface& surface : surfaces.surfaces()) {
        if (surface.value > values.low && surface.value <= values.high) continue;
        std::fprintf(stderr, "cellproj: warning: --iso %g: no surface there, field \"%s\" is %g .. %g%s\n", surface.value, field.name.c_str(),
                     values.low, values.high, surface.value == values.low ? " and nowhere below" : "");
    }
}

}  // namespace cellproj::cli
