// SPDX-License-Identifier: BSD-3-Clause
//
// What `render` draws around and over the picture for its reader: --color-bar, --axes, --outline, --title, --units, --font.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "render/annotation/annotation.hpp"
#include "scene_options.hpp"

namespace CLI {
class App;
}

namespace cellproj::cli {

struct AnnotationOptions {
    Annotations annotations;  // but for the background, which is the picture's
    std::filesystem::path font = default_font_file();
};

// Into `options`, which must live as long as the command.
void add_annotation_options(CLI::App& command, AnnotationOptions& options);

// What can be refused without reading the mesh: EXR, which holds what was computed and nothing else; pictures too small for text; a font that
// is missing. Throws Error. The font, null when there is no text.
std::shared_ptr<const Font> require_annotated(const AnnotationOptions& options, const std::filesystem::path& output, ImageSize size);

// The annotator of all pictures, for a colour behind them of 3 channels 0..1. Says on stderr what the bar's note says in the picture, and
// which characters the font lacks. Throws Error as Annotator does.
Annotator make_annotator(const AnnotationOptions& options, const SceneOptions& scene_options, const Scene& scene, ImageSize size,
                         const std::vector<double>& background, std::shared_ptr<const Font> font);

}  // namespace cellproj::cli
