// SPDX-License-Identifier: BSD-3-Clause
#include "annotation_options.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <map>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj::cli {

namespace {

const std::map<std::string, BarSide> sides{{"left", BarSide::left}, {"right", BarSide::right}, {"bottom", BarSide::bottom}};

void warn_of_missing_characters(const Font& font, const std::string& text, const AnnotationOptions& options) {
    const std::string missing = font.missing_character(text);
    if (missing.empty()) return;
    std::fprintf(stderr, "cellproj: warning: \"%s\" has the character %s, which %s lacks: an empty box is drawn; name another font by --font\n",
                 text.c_str(), missing.c_str(), options.font.c_str());
}

}  // namespace

void add_annotation_options(CLI::App& command, AnnotationOptions& options) {
    CLI::Option* bar = command.add_option_function<std::string>(
        "--color-bar",
        [&options](const std::string& side) {
            const auto found = sides.find(side.empty() ? "right" : side);
            if (found == sides.end()) throw CLI::ValidationError("--color-bar", side + " is not left, right or bottom");
            options.annotations.color_bar = found->second;
        },
        "Draw the colours, their scalars and their opacity beside the volume: left, right (if none is named) or bottom");
    bar->expected(0, 1)->type_name("[SIDE]");
    command.add_option("--units", options.annotations.units, "Units of the field, for the colour bar")->needs(bar);
    command.add_flag("--axes", options.annotations.axes, "Draw the directions of x, y and z in the corner");
    command.add_flag("--outline", options.annotations.outline, "Draw the edges of the mesh's box, before and behind the volume");
    command.add_option("--title", options.annotations.title, "A title above the volume");
    command.add_option("--font", options.font, "Font file of all text; default: DejaVu Sans");
}

std::shared_ptr<const Font> require_annotated(const AnnotationOptions& options, const std::filesystem::path& output, ImageSize size) {
    if (!options.annotations.any()) return nullptr;
    if (output.extension() == ".exr") {
        throw Error({.kind = ErrorKind::option,
                     .place = "--color-bar, --axes, --outline, --title",
                     .expected = "a PNG: an EXR holds what was computed and nothing else",
                     .found = output.string(),
                     .advice = "write a .png, or leave them out"});
    }
    require_room(options.annotations, size);
    return options.annotations.text() ? std::make_shared<const Font>(options.font, "--font") : nullptr;
}

Annotator make_annotator(const AnnotationOptions& options, const SceneOptions& scene_options, const Scene& scene, ImageSize size,
                         const std::vector<double>& background, std::shared_ptr<const Font> font) {
    Annotations annotations = options.annotations;
    if (scene_options.axis == "log") annotations.bar_axis = ScalarAxis::log;
    annotations.background = {background[0], background[1], background[2]};
    if (font) {
        warn_of_missing_characters(*font, annotations.title, options);
        if (annotations.color_bar) warn_of_missing_characters(*font, scene.field->name + annotations.units, options);
    }
    Annotator annotator(annotations, scene, size, std::move(font));
    if (!annotator.note().empty()) std::fprintf(stderr, "cellproj: note: %s\n", annotator.note().c_str());
    return annotator;
}

}  // namespace cellproj::cli
