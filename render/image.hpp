// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures in memory and on disk.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace cellproj {

// RGBA float32, associated (premultiplied), display-referred. Row 0 is the top row.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<glm::vec4> pixels;  // width · height, row-major

    Image() = default;
    Image(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    glm::vec4& at(int x, int y) {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    const glm::vec4& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

// Throws Error (file) unless `file` can be created in an existing, writable folder and its suffix is .png or .exr. Call
// it before long work.
void require_writable_image(const std::filesystem::path& file);

struct PngOptions {
    glm::dvec3 background{1.0};  // the colour behind the volume, 0..1
    int bits = 8;                // per channel: 8 or 16
    // Keyword (1 .. 79 ASCII characters) → value (UTF-8): tEXt chunks, iTXt where a value is more than ASCII.
    std::map<std::string, std::string> text;
};

// Pixels with a NaN or an infinity in any channel. No renderer should make them: a program that finds some says so.
std::size_t count_non_finite(const Image& image);

// The file appears under its name only when it is complete: written beside it under a temporary name, then renamed.
// PNG: opaque RGB, colour + (1 − α)·background, clamped to 0..1, rounded to nearest; a pixel that is not finite in any
// channel counts as empty and shows the background. EXR: the float32 RGBA as it is, NaN and infinities included, `text`
// as string attributes. Both throw Error (file) when the file cannot be written completely; the image has at least one
// pixel.
void write_png(const Image& image, const std::filesystem::path& file, const PngOptions& options = {});
// The same bytes in memory.
std::string encode_png(const Image& image, const PngOptions& options = {});
void write_exr(const Image& image, const std::filesystem::path& file,
               const std::map<std::string, std::string>& text = {});

}  // namespace cellproj
