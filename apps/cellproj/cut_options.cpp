// SPDX-License-Identifier: BSD-3-Clause
#include "cut_options.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include "apps/scenes/sphere_flow.hpp"
#include "mesh/error.hpp"
#include "mesh/surface.hpp"
#include "option_text.hpp"

namespace cellproj::cli {

namespace {

constexpr const char* embedded_body = "demo:sphere";

[[noreturn]] void refuse(const char* option, const std::string& expected, const std::string& found, const std::string& advice) {
    throw Error({ErrorKind::option, option, expected, "\"" + found + "\"", advice});
}

HalfSpace parse_plane(const char* option, const std::string& text, const char* advice) {
    const auto parts = split(text, ':');
    const auto point = to_point(parts[0]), normal = parts.size() == 2 ? to_point(parts[1]) : std::nullopt;
    if (!point || !normal) refuse(option, "a point and a normal, X,Y,Z:NX,NY,NZ", text, advice);
    return {*point, *normal};
}

Bounds parse_box(const std::string& text) {
    const auto numbers = to_numbers(text, 6);
    if (!numbers) refuse("--clip-box", "two opposite corners, X0,Y0,Z0,X1,Y1,Z1", text, "give six numbers with commas between");
    const std::vector<double>& v = *numbers;
    const Bounds box{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
    if (!(box.low.x < box.high.x && box.low.y < box.high.y && box.low.z < box.high.z))
        refuse("--clip-box", "X0 < X1, Y0 < Y1 and Z0 < Z1", text, "give the lowest corner first");
    return box;
}

std::string in_words(const Bounds& box) {
    char text[256];
    std::snprintf(text, sizeof text, "%g,%g,%g,%g,%g,%g", box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z);
    return text;
}

// Of what the region keeps, if there is one.
void add_slices(const CutOptions& options, std::shared_ptr<const TransferFunction> colors, const Grid* grid, Scene& scene) {
    if (options.slices.empty() && !options.caps) return;
    std::vector<Slice> slices = slices_and_caps(parse_slices(options), options.caps ? scene.clip.get() : nullptr);
    auto sliced = grid ? SliceScene{std::move(slices), std::move(colors)}
                       : cut_slices(*scene.mesh, *scene.field, scene.opacity_field.get(), std::move(slices), std::move(colors));
    const Bounds box = bounds(scene.mesh->points);
    for (std::size_t i = 0; i < options.slices.size(); ++i) {
        if (grid ? slice_meets(sliced.slices[i], grid->bounds()) : !sliced.cuts[i].empty()) continue;
        std::fprintf(stderr, "cellproj: warning: --slice %s: nothing of the mesh is in this plane; the mesh lies in %s\n",
                     options.slices[i].c_str(), in_words(box).c_str());
    }
    scene.slices = std::make_shared<const SliceScene>(std::move(sliced));
}

}  // namespace

void add_cut_options(CLI::App& command, CutOptions& options) {
    command.add_option("--clip", options.planes,
                       "Draw only the side of a plane that its normal points to: X,Y,Z:NX,NY,NZ, a point of it and the normal (again for more)")
        ->allow_extra_args(false);
    command.add_option("--clip-box", options.box, "Draw only what is inside a box: X0,Y0,Z0,X1,Y1,Z1");
    command.add_option("--slice", options.slices,
                       "Draw the field on a plane, opaque, in the colours of the bar: X,Y,Z:NX,NY,NZ, a point of it and its normal (again for more); "
                       "without the volume around it, unless there is --volume")
        ->allow_extra_args(false);
    command.add_flag("--caps", options.caps, "Close what --clip and --clip-box cut open by the field on their planes, as --slice draws it");
    command.add_option("--surface", options.surfaces,
                       std::string("Draw an opaque body, a surface of STL, OFF, PLY, OBJ or VTP, or that of demo:sphere: FILE[:COLOR] (again for more); it is not clipped. COLOR: ") +
                           color_forms + "; default: gray")
        ->allow_extra_args(false);
}

ClipRegion parse_region(const CutOptions& options) {
    ClipRegion region;
    if (!options.box.empty()) region = box_region(parse_box(options.box));
    for (const std::string& plane : options.planes) region.half_spaces.push_back(parse_plane("--clip", plane, "0,0,0:1,0,0 keeps what is right of the origin"));
    validate(region, "--clip");
    return region;
}

std::vector<HalfSpace> parse_slices(const CutOptions& options) {
    ClipRegion planes;
    for (const std::string& slice : options.slices)
        planes.half_spaces.push_back(parse_plane("--slice", slice, "0,0,0:1,0,0 is the plane across x through the origin"));
    validate(planes, "--slice");
    return planes.half_spaces;
}

RayCuts planned_cuts(const CutOptions& options) {
    const std::size_t planes = parse_region(options).half_spaces.size();
    return {planes, options.surfaces.size(), options.slices.size(), options.caps ? planes : 0};
}

// File names may hold colons: what is a file as it stands is one.
BodyChoice parse_body(const std::string& text) {
    const glm::dvec3 gray(0.7);
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos || text == embedded_body || std::filesystem::exists(text)) return {text, gray};
    const auto color = to_color(std::string_view(text).substr(colon + 1));
    if (!color) refuse("--surface", std::string("a colour behind the file: ") + color_forms, text.substr(colon + 1), "leave it out for gray");
    return {text.substr(0, colon), *color};
}

void add_cuts(const CutOptions& options, const Lighting& lighting, std::shared_ptr<const TransferFunction> colors, const Grid* grid, Scene& scene) {
    ClipRegion region = parse_region(options);
    if (!region.half_spaces.empty()) {
        const Bounds box = bounds(scene.mesh->points);
        if (!meets(region, box)) {
            throw Error({ErrorKind::option, options.planes.empty() ? "--clip-box" : "--clip", "a region with something of the mesh, which lies in " + in_words(box),
                         "one with nothing of it", "the side is kept that the normal points to"});
        }
        scene.clip = std::make_shared<const ClipRegion>(std::move(region));
    }
    add_slices(options, std::move(colors), grid, scene);
    if (options.surfaces.empty()) return;
    BodyScene bodies{.bodies = {}, .lighting = lighting};
    for (const std::string& text : options.surfaces) {
        const BodyChoice choice = parse_body(text);
        bodies.bodies.push_back(make_body(choice.file == embedded_body ? make_sphere_surface() : read_surface(choice.file), choice.color));
    }
    scene.bodies = std::make_shared<const BodyScene>(std::move(bodies));
}

std::string text_of(const CutOptions& options) {
    std::string text;
    const auto add = [&](const char* option, const std::string& value) { text += (text.empty() ? "" : " ") + std::string(option) + " " + value; };
    if (!options.box.empty()) add("--clip-box", options.box);
    for (const std::string& plane : options.planes) add("--clip", plane);
    if (options.caps) text += (text.empty() ? "" : " ") + std::string("--caps");
    for (const std::string& slice : options.slices) add("--slice", slice);
    for (const std::string& surface : options.surfaces) add("--surface", surface);
    return text;
}

}  // namespace cellproj::cli
