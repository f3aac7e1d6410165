// SPDX-License-Identifier: BSD-3-Clause
#include <png.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "mesh/error.hpp"
#include "render/image.hpp"
#include "render/output_file.hpp"

namespace cellproj {

namespace {

bool is_finite(const glm::vec4& p) {
    return std::isfinite(p.r) && std::isfinite(p.g) && std::isfinite(p.b) && std::isfinite(p.a);
}

// 0..1 to 0..largest, rounded to nearest; NaN gives 0. Clamped first, because converting a number beyond the integer's
// range is undefined behaviour.
unsigned quantize(double value, unsigned largest) {
    const double clamped = value > 0.0 ? std::min(value, 1.0) : 0.0;
    return static_cast<unsigned>(clamped * largest + 0.5);
}

// One row of samples as PNG stores them: RGB, 16-bit samples with the high byte first.
void encode_row(const Image& image, int y, const PngOptions& options, std::vector<png_byte>& row) {
    const unsigned largest = (1U << options.bits) - 1U;
    auto byte = row.begin();
    for (int x = 0; x < image.width; ++x) {
        const glm::vec4 pixel = is_finite(image.at(x, y)) ? image.at(x, y) : glm::vec4(0);
        for (int channel = 0; channel < 3; ++channel) {
            const double value = double(pixel[channel]) + (1.0 - double(pixel.a)) * options.background[channel];
            const unsigned sample = quantize(value, largest);
            if (options.bits == 16) *byte++ = static_cast<png_byte>(sample >> 8);
            *byte++ = static_cast<png_byte>(sample & 0xffU);
        }
    }
}

bool is_ascii(const std::string& text) {
    return std::all_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x80; });
}

// tEXt holds Latin-1; what is more than ASCII goes as UTF-8 into iTXt. The result points into `text`.
std::vector<png_text> text_chunks(const std::map<std::string, std::string>& text) {
    std::vector<png_text> chunks;
    for (const auto& [keyword, value] : text) {
        assert(!keyword.empty() && keyword.size() <= 79 && is_ascii(keyword) && "PNG's limits of keywords");
        png_text chunk{};
        chunk.key = const_cast<char*>(keyword.c_str());  // libpng copies and does not write
        chunk.text = const_cast<char*>(value.c_str());
        chunk.text_length = value.size();
        chunk.compression = is_ascii(value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
        chunks.push_back(chunk);
    }
    return chunks;
}

// Takes bytes; false when it cannot.
using Sink = std::function<bool(const png_byte* data, std::size_t bytes)>;

void png_write_bytes(png_structp png, png_bytep data, std::size_t bytes) {
    if (!(*static_cast<const Sink*>(png_get_io_ptr(png)))(data, bytes)) png_error(png, "cannot write");
}

void png_flush_nothing(png_structp) {}

void png_remember_error(png_structp png, png_const_charp message) {
    *static_cast<std::string*>(png_get_error_ptr(png)) = message;
    png_longjmp(png, 1);
}

void png_ignore_warning(png_structp, png_const_charp) {}

// The two objects of libpng that make a file.
struct PngWriter {
    png_structp png;
    png_infop info = nullptr;

    explicit PngWriter(std::string& error)
        : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &error, png_remember_error, png_ignore_warning)) {
        if (png) info = png_create_info_struct(png);
    }
    ~PngWriter() { png_destroy_write_struct(&png, &info); }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
};

// libpng reports errors by a jump back into this function, over any destructor in between: everything with one lives in
// the caller. False after an error.
bool encode(png_structp png, png_infop info, const Image& image, const PngOptions& options,
            const std::vector<png_text>& chunks, std::vector<png_byte>& row) {
    if (setjmp(png_jmpbuf(png))) return false;
    // The largest view is 16384 pixels wide, libpng's own bound is a million.
    png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), options.bits,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_text(png, info, chunks.data(), static_cast<int>(chunks.size()));
    png_write_info(png, info);
    for (int y = 0; y < image.height; ++y) {
        encode_row(image, y, options, row);
        png_write_row(png, row.data());
    }
    png_write_end(png, nullptr);
    return true;
}

// What libpng says when it fails, nothing when the sink has taken the whole picture.
std::optional<std::string> encode_to(Sink sink, const Image& image, const PngOptions& options) {
    assert(image.width > 0 && image.height > 0 && (options.bits == 8 || options.bits == 16));
    std::string error = "out of memory";
    const PngWriter writer(error);
    std::vector<png_byte> row(static_cast<std::size_t>(image.width) * 3 * static_cast<std::size_t>(options.bits / 8));
    const std::vector<png_text> chunks = text_chunks(options.text);
    if (!writer.info) return error;
    png_set_write_fn(writer.png, &sink, png_write_bytes, png_flush_nothing);
    if (!encode(writer.png, writer.info, image, options, chunks, row)) return error;
    return std::nullopt;
}

[[noreturn]] void throw_refused(const std::string& place, std::string found) {
    throw Error({.kind = ErrorKind::file,
                 .place = place,
                 .expected = "a picture that libpng can write",
                 .found = std::move(found),
                 .advice = "write OpenEXR (.exr) instead"});
}

}  // namespace

void require_writable_image(const std::filesystem::path& file) {
    const std::string suffix = file.extension().string();
    if (suffix != ".png" && suffix != ".exr")
        throw Error({.kind = ErrorKind::file,
                     .place = file.string(),
                     .expected = "a name that ends in .png or .exr",
                     .found = suffix.empty() ? "no suffix" : "the suffix " + suffix,
                     .advice = "name the picture " + std::filesystem::path(file).replace_extension(".png").string()});
    require_writable(file);
}

std::size_t count_non_finite(const Image& image) {
    return static_cast<std::size_t>(
        std::count_if(image.pixels.begin(), image.pixels.end(), [](const glm::vec4& p) { return !is_finite(p); }));
}

void write_png(const Image& image, const std::filesystem::path& file, const PngOptions& options) {
    OutputFile out(file);
    const auto to_file = [&](const png_byte* data, std::size_t bytes) { return out.write(data, bytes); };
    std::optional<std::string> error = encode_to(to_file, image, options);
    if (error && !out.failed()) throw_refused(file.string(), std::move(*error));
    out.commit();
}

std::string encode_png(const Image& image, const PngOptions& options) {
    std::string bytes;
    const auto to_memory = [&](const png_byte* data, std::size_t count) {
        bytes.append(reinterpret_cast<const char*>(data), count);
        return true;
    };
    std::optional<std::string> error = encode_to(to_memory, image, options);
    if (error) throw_refused("picture", std::move(*error));
    return bytes;
}

}  // namespace cellproj
