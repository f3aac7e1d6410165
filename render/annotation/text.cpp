// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation/text.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <system_error>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

constexpr char32_t replacement = 0xFFFD;

// The code point at text[i], and i behind it. Overlong forms, surrogates and what is cut off count as one wrong byte (RFC 3629).
char32_t next_code_point(std::string_view text, std::size_t& i) {
    const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U; };
    const unsigned first = byte(i);
    const std::size_t length = first < 0x80 ? 1 : first >= 0xC2 && first < 0xE0 ? 2 : first >= 0xE0 && first < 0xF0 ? 3 : first >= 0xF0 && first < 0xF5 ? 4 : 0;
    if (length == 0) return ++i, replacement;
    char32_t code = length == 1 ? first : first & (0x7FU >> length);
    for (std::size_t k = 1; k < length; ++k) {
        if ((byte(i + k) & 0xC0U) != 0x80U) return ++i, replacement;
        code = code << 6 | (byte(i + k) & 0x3FU);
    }
    const bool wrong = (length == 3 && code < 0x800) || (length == 4 && (code < 0x10000 || code > 0x10FFFF)) || (code >= 0xD800 && code < 0xE000);
    if (wrong) return ++i, replacement;
    i += length;
    return code < 0x20 || (code >= 0x7F && code < 0xA0) ? U' ' : code;
}

std::vector<char32_t> code_points(std::string_view text) {
    std::vector<char32_t> codes;
    for (std::size_t i = 0; i < text.size();) codes.push_back(next_code_point(text, i));
    return codes;
}

// Where characters begin, and the end.
std::vector<std::size_t> character_bounds(std::string_view text) {
    std::vector<std::size_t> bounds{0};
    for (std::size_t i = 0; i < text.size(); bounds.push_back(i)) next_code_point(text, i);
    return bounds;
}

// FreeType counts in 1/64 of a pixel.
FT_F26Dot6 in_64ths(double pixels) { return static_cast<FT_F26Dot6>(std::lround(64 * pixels)); }

}  // namespace

struct Font::Face {
    FT_Library library = nullptr;
    FT_Face face = nullptr;

    ~Face() {
        if (face) FT_Done_Face(face);
        if (library) FT_Done_FreeType(library);
    }

    void set_size(double size) const {
        assert(size >= 1 && size <= 1000);
        FT_Set_Char_Size(face, 0, in_64ths(size), 72, 72);
    }

    double font_units(double size, double units) const { return units * size / face->units_per_EM; }

    // Calls visit(glyph, x) for each character, x the pen [pixels]; where the pen is at last. Distances are those of the unhinted font,
    // which scale with the size.
    template <class Visit>
    double walk(std::string_view text, double size, Visit visit) const {
        double x = 0;
        FT_UInt before = 0;
        for (const char32_t code : code_points(text)) {
            const FT_UInt glyph = FT_Get_Char_Index(face, code);
            FT_Vector kerning{};
            if (before && glyph && FT_HAS_KERNING(face)) FT_Get_Kerning(face, before, glyph, FT_KERNING_UNSCALED, &kerning);
            x += font_units(size, static_cast<double>(kerning.x));
            visit(glyph, x);
            if (FT_Load_Glyph(face, glyph, FT_LOAD_NO_SCALE) == 0) x += font_units(size, static_cast<double>(face->glyph->metrics.horiAdvance));
            before = glyph;
        }
        return x;
    }
};

std::filesystem::path default_font_file() { return "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"; }

Font::Font(const std::filesystem::path& file, const std::string& place) : face_(std::make_unique<Face>()) {
    if (FT_Init_FreeType(&face_->library) != 0) throw Error({ErrorKind::environment, "FreeType", "a library that starts", "an error", "install libfreetype6"});
    std::error_code ignored;
    const bool there = std::filesystem::is_regular_file(file, ignored);
    if (!there && file == default_font_file())
        throw Error({ErrorKind::environment, file.string(), "the font for text in pictures", "no such file",
                     "install fonts-dejavu-core, or name a font by " + place + " FILE"});
    const FT_Error error = there ? FT_New_Face(face_->library, file.c_str(), 0, &face_->face) : FT_Err_Cannot_Open_Resource;
    if (error != 0 || !FT_IS_SCALABLE(face_->face) || face_->face->units_per_EM == 0)
        throw Error({ErrorKind::option, place, "a font file that can be scaled (TrueType, OpenType, Type 1)",
                     file.string() + (there ? ", which is none" : ", which is no file"), "name another one, or leave " + place + " out for DejaVu Sans"});
    FT_Select_Charmap(face_->face, FT_ENCODING_UNICODE);  // a font of symbols has none: all its characters are missing
}

Font::~Font() = default;
Font::Font(Font&&) noexcept = default;
Font& Font::operator=(Font&&) noexcept = default;

double Font::advance(std::string_view text, double size) const {
    return face_->walk(text, size, [](FT_UInt, double) {});
}

TextMask Font::draw(std::string_view text, double size) const {
    struct Glyph {
        int x, y, width, height;  // of its first pixel from the pen's start, y downwards
        std::vector<std::uint8_t> pixels;
    };
    std::vector<Glyph> glyphs;
    TextMask mask;
    face_->set_size(size);
    mask.advance = face_->walk(text, size, [&](FT_UInt index, double x) {
        // Light hinting moves outlines in y only: letters stand on whole rows, and between whole columns where they belong.
        if (FT_Load_Glyph(face_->face, index, FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP) != 0) return;
        const FT_GlyphSlot slot = face_->face->glyph;
        const double column = std::floor(x);
        if (slot->format == FT_GLYPH_FORMAT_OUTLINE) FT_Outline_Translate(&slot->outline, in_64ths(x - column), 0);
        if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL) != 0 || slot->bitmap.width == 0 || slot->bitmap.rows == 0) return;
        const FT_Bitmap& bitmap = slot->bitmap;
        Glyph glyph{static_cast<int>(column) + slot->bitmap_left, -slot->bitmap_top, static_cast<int>(bitmap.width), static_cast<int>(bitmap.rows), {}};
        for (int row = 0; row < glyph.height; ++row) {
            const std::uint8_t* const first = bitmap.buffer + static_cast<std::ptrdiff_t>(row) * bitmap.pitch;
            glyph.pixels.insert(glyph.pixels.end(), first, first + glyph.width);
        }
        glyphs.push_back(std::move(glyph));
    });
    if (glyphs.empty()) return mask;

    int right = glyphs[0].x, bottom = glyphs[0].y, left = right, top = bottom;
    for (const Glyph& g : glyphs) {
        left = std::min(left, g.x);
        top = std::min(top, g.y);
        right = std::max(right, g.x + g.width);
        bottom = std::max(bottom, g.y + g.height);
    }
    mask.width = right - left;
    mask.height = bottom - top;
    mask.left = left;
    mask.above = -top;
    mask.coverage.assign(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height), 0.0F);
    for (const Glyph& g : glyphs)
        for (int y = 0; y < g.height; ++y)
            for (int x = 0; x < g.width; ++x) {
                const auto at = static_cast<std::size_t>(g.y - top + y) * static_cast<std::size_t>(mask.width) + static_cast<std::size_t>(g.x - left + x);
                const float value = static_cast<float>(g.pixels[static_cast<std::size_t>(y * g.width + x)]) / 255.0F;
                mask.coverage[at] = std::max(mask.coverage[at], value);  // glyphs touch, they do not cover each other
            }
    return mask;
}

double Font::cap_height(double size) const {
    const FT_UInt glyph = FT_Get_Char_Index(face_->face, U'H');
    const bool has = glyph != 0 && FT_Load_Glyph(face_->face, glyph, FT_LOAD_NO_SCALE) == 0;
    return has ? face_->font_units(size, static_cast<double>(face_->face->glyph->metrics.horiBearingY)) : 0.7 * size;
}

double Font::line_height(double size) const { return face_->font_units(size, face_->face->height); }

std::string Font::missing_character(std::string_view text) const {
    for (const char32_t code : code_points(text)) {
        if (FT_Get_Char_Index(face_->face, code) != 0) continue;
        char name[16];
        std::snprintf(name, sizeof name, "U+%04X", static_cast<unsigned>(code));
        return name;
    }
    return {};
}

TextMask turned_left(const TextMask& mask) {
    TextMask turned{.width = mask.height, .height = mask.width, .left = -mask.above, .above = mask.width + mask.left, .advance = mask.advance, .coverage = {}};
    turned.coverage.resize(mask.coverage.size());
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
            turned.coverage[static_cast<std::size_t>(mask.width - 1 - x) * static_cast<std::size_t>(turned.width) + static_cast<std::size_t>(y)] = mask.at(x, y);
    return turned;
}

std::string shortened(const Font& font, std::string_view text, double size, double width) {
    if (font.advance(text, size) <= width) return std::string(text);
    const auto part = [&](std::size_t bound) { return std::string(text.substr(0, bound)) + "…"; };
    const std::vector<std::size_t> bounds = character_bounds(text);
    const auto too_long = std::partition_point(bounds.begin(), bounds.end(), [&](std::size_t b) { return font.advance(part(b), size) <= width; });
    return too_long == bounds.begin() ? "" : part(*(too_long - 1));
}

namespace {

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; (begin = text.find_first_not_of(' ', begin)) != std::string_view::npos;) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        words.emplace_back(text.substr(begin, end - begin));
        begin = end;
    }
    return words;
}

// As many words in each line as fit.
std::vector<std::string> filled_lines(const Font& font, const std::vector<std::string>& words, double size, double width) {
    std::vector<std::string> lines;
    for (const std::string& word : words) {
        const std::string joined = lines.empty() ? word : lines.back() + " " + word;
        if (!lines.empty() && font.advance(joined, size) <= width)
            lines.back() = joined;
        else
            lines.push_back(word);
    }
    return lines;
}

}  // namespace

std::vector<std::string> wrapped(const Font& font, std::string_view text, double size, double width) {
    std::vector<std::string> words = words_of(text);
    double too_narrow = 0, enough = width;  // for the number of lines that fill the width
    for (std::string& word : words) {
        word = shortened(font, word, size, width);
        too_narrow = std::max(too_narrow, font.advance(word, size) - 1e-9);
    }
    std::vector<std::string> lines = filled_lines(font, words, size, width);
    while (lines.size() > 1 && enough - too_narrow > size / 2) {
        const double between = (enough + too_narrow) / 2;
        std::vector<std::string> narrower = filled_lines(font, words, size, between);
        if (narrower.size() > lines.size()) {
            too_narrow = between;
        } else {
            enough = between;
            lines = std::move(narrower);
        }
    }
    return lines;
}

}  // namespace cellproj
