// SPDX-License-Identifier: BSD-3-Clause
//
// Text as coverage: one line of one font, by FreeType. No shaping: one glyph for each code point, from left to right, with the pairs of
// the font's kern table.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace cellproj {

// Coverage 0..1 of pixels. A pixel (x, y) of the mask belongs at pen + (x + left, y − above), the pen on the baseline.
struct TextMask {
    int width = 0, height = 0;
    int left = 0;                 // pixels from the pen to the first column
    int above = 0;                // rows above the baseline
    double advance = 0;           // how far the pen moves [pixels]
    std::vector<float> coverage;  // width · height, row-major

    float at(int x, int y) const { return coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]; }
};

// The same, reading from bottom to top.
TextMask turned_left(const TextMask& mask);

// DejaVu Sans, where Debian's package fonts-dejavu-core puts it.
std::filesystem::path default_font_file();

// Sizes are those of the em square in pixels, 1 .. 1000.
class Font {
public:
    // TrueType, OpenType, Type 1: what FreeType reads and can be scaled. Throws Error: (environment) when the default font is missing,
    // naming its package; (option) at `place` when a file of the user is missing or no such font.
    explicit Font(const std::filesystem::path& file = default_font_file(), const std::string& place = "--font");
    ~Font();
    Font(Font&&) noexcept;
    Font& operator=(Font&&) noexcept;

    // UTF-8; bytes that are none become U+FFFD, control characters spaces. What the font lacks is drawn as its empty box.
    TextMask draw(std::string_view text, double size) const;
    double advance(std::string_view text, double size) const;  // that of `draw`, in less time

    double cap_height(double size) const;   // of an H above the baseline
    double line_height(double size) const;  // from baseline to baseline
    // The first code point of the text that the font has no glyph for, as "U+4E2D"; empty when there is none.
    std::string missing_character(std::string_view text) const;

private:
    struct Face;
    std::unique_ptr<Face> face_;
};

// As few lines of at most `width` pixels as there can be, about equally long, broken at spaces; a word that is longer by itself is cut and ends
// in "…". None for an empty text.
std::vector<std::string> wrapped(const Font& font, std::string_view text, double size, double width);
// The text, or as much of it as fits with "…" behind.
std::string shortened(const Font& font, std::string_view text, double size, double width);

}  // namespace cellproj
