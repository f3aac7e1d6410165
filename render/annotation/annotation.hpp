// SPDX-License-Identifier: BSD-3-Clause
//
// What stands around and over a picture for its reader: colour bar, axes, outline, title, and a note of what the colours leave out.
//
// Nothing of the volume is covered by text: bar, title and note get room of their own at the picture's sides, and all that the picture
// would show without them is drawn, smaller, into the rectangle that is left (the view). Axes and outline are drawn over the view.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"
#include "project/camera.hpp"
#include "render/annotation/canvas.hpp"
#include "render/annotation/color_bar.hpp"
#include "render/annotation/text.hpp"
#include "render/image.hpp"
#include "render/scene.hpp"

namespace cellproj {

struct Annotations {
    std::optional<BarSide> color_bar = {};
    std::string units = {};  // of the field, written behind its name beside the bar; UTF-8
    ScalarAxis bar_axis = ScalarAxis::linear;  // log for functions that were spread over ln s: they do not tell
    bool axes = false;       // a triad in the lower left corner of the view
    bool outline = false;    // of the mesh's box (annotation_outline.hpp)
    std::string title = {};  // above the view; UTF-8, broken at spaces where it is too long
    // What the picture will be written over, 0..1: text is black or white, whatever has more contrast.
    glm::dvec3 background{1.0};

    bool any() const { return color_bar || axes || outline || !title.empty(); }
    bool text() const { return color_bar || axes || !title.empty(); }
};

// Throws Error (option, naming --size) for pictures whose shorter side is below 96 pixels, where text would be no text.
void require_room(const Annotations& annotations, ImageSize size);

// Annotations of pictures of one scene and size. Text is 1/38 of the shorter side high, at least 9 pixels.
class Annotator {
public:
    // Without annotations: the view is the picture, and `compose` changes nothing. `font` may be null when there is no text. Throws Error
    // (option, naming --size) as `require_room`, and when less than half of the width or height would be left for the view.
    Annotator(const Annotations& annotations, const Scene& scene, ImageSize size, std::shared_ptr<const Font> font);

    PixelBox view() const { return view_; }
    ImageSize view_size() const { return {view_.width(), view_.height()}; }
    // The camera that shows in the view all that `camera` shows in a picture of the whole size, as large as fits.
    Camera view_camera(const Camera& camera) const;

    // The whole picture from that of the view (`view_size`), drawn by `view_camera(camera)`. Pixels of the view that no axis and no line
    // touches keep their bits.
    Image compose(Image view, const Camera& camera) const;

    // In words: which values of the field lie beyond the bar and what becomes of them. Empty without a bar, or when all are inside.
    const std::string& note() const { return note_; }
    const std::optional<ColorBarPlan>& color_bar() const { return bar_; }

private:
    Image on_canvas(Image view) const;
    void place_lines(const std::string& text, double size, PixelBox& left_over, bool above);

    Annotations annotations_;
    ImageSize size_;
    Bounds box_;
    std::shared_ptr<const Font> font_;
    AnnotationStyle style_;
    PixelBox view_;
    std::optional<ColorBarPlan> bar_;
    std::vector<PlacedText> lines_;  // of title and note
    std::string note_;
};

}  // namespace cellproj
