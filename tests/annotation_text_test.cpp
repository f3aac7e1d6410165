// SPDX-License-Identifier: BSD-3-Clause
//
// Ticks and their labels against decimals in closed form; text against the measures of the font.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <random>

#include "mesh/error.hpp"
#include "render/annotation/text.hpp"
#include "render/annotation/ticks.hpp"
#include "tests/support/folder_test.hpp"

namespace cellproj {
namespace annotation_text_test {

std::vector<std::string> labels_of(const Ticks& ticks) {
    std::vector<std::string> labels;
    for (const Tick& tick : ticks.ticks) labels.push_back(tick.label);
    return labels;
}

using Labels = std::vector<std::string>;

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    for (std::size_t at; (at = text.find(what)) != std::string::npos;) text.replace(at, what.size(), with);
    return text;
}

// "−1.5×10⁻⁷" as a reader takes it.
long double read_number(std::string text) {
    static const std::map<std::string, std::string> plain{{"⁰", "0"}, {"¹", "1"}, {"²", "2"}, {"³", "3"}, {"⁴", "4"}, {"⁵", "5"},
                                                          {"⁶", "6"}, {"⁷", "7"}, {"⁸", "8"}, {"⁹", "9"}, {"⁻", "-"}, {"−", "-"}};
    for (const auto& [from, to] : plain) text = replaced(text, from, to);
    return std::strtold(replaced(text, "×10", "e").c_str(), nullptr);
}

// What an axis says that a label stands for: label · 10^exponent + offset.
long double read_label(const std::string& label, const std::string& common) {
    const std::size_t space = common.find(' ');
    std::string scale = common, offset;
    if (space != std::string::npos) {
        scale = common.substr(0, space);
        offset = common.substr(space + 1);
    } else if (!common.empty() && common.find("×10") != 0) {
        scale.clear();
        offset = common;
    }
    const long double factor = scale.empty() ? 1 : read_number("1" + scale);
    return read_number(label) * factor + (offset.empty() ? 0 : read_number(offset));
}

TEST(AnnotationTicks, AreThoseOfAHand) {
    EXPECT_EQ(labels_of(nice_ticks(0, 1, 5)), (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
    EXPECT_EQ(labels_of(nice_ticks(0.6, 4.9, 9)), (Labels{"1.0", "1.5", "2.0", "2.5", "3.0", "3.5", "4.0", "4.5"}));
    EXPECT_EQ(labels_of(nice_ticks(-30, 70, 5)), (Labels{"−20", "0", "20", "40", "60"}));
    EXPECT_EQ(labels_of(nice_ticks(101325, 150000, 6)), (Labels{"110000", "120000", "130000", "140000", "150000"}));
    // 0.1 · 3 is more than 0.3 in float64: a tick at the end all the same, and not beyond it.
    const Ticks tenths = nice_ticks(0.1, 0.3, 2);
    EXPECT_EQ(labels_of(tenths), (Labels{"0.1", "0.2", "0.3"}));
    EXPECT_EQ(tenths.ticks.back().value, 0.3);
    EXPECT_EQ(tenths.common, "");
}

TEST(AnnotationTicks, EndsAreRoundedToAHundredthOfTheStep) {
    const Ticks ticks = nice_ticks(0.113847, 5.86123, 6);
    EXPECT_EQ(labels_of(ticks), (Labels{"1", "2", "3", "4", "5"}));
    EXPECT_EQ(ticks.low.label, "0.11");
    EXPECT_EQ(ticks.high.label, "5.86");
    EXPECT_EQ(nice_ticks(0.397, 4.9, 5).low.label, "0.40") << "rounded";
    EXPECT_EQ(nice_ticks(0.397, 4.9, 5).high.label, "4.9") << "exact";
    EXPECT_EQ(ticks.low.value, 0.113847);
    EXPECT_EQ(ticks.high.value, 5.86123);
}

TEST(AnnotationTicks, LeaveOutWhatAllLabelsShare) {
    Ticks ticks = nice_ticks(1e6, 1e6 + 1e-3, 5);
    EXPECT_EQ(ticks.common, "+1000000");
    EXPECT_EQ(labels_of(ticks), (Labels{"0.0000", "0.0002", "0.0004", "0.0006", "0.0008", "0.0010"}));
    ticks = nice_ticks(-101326.3, -101325, 3);
    EXPECT_EQ(ticks.common, "−101325");
    EXPECT_EQ(labels_of(ticks), (Labels{"−1.0", "−0.5", "0.0"}));
    ticks = nice_ticks(0, 2.5e-7, 5);
    EXPECT_EQ(ticks.common, "×10⁻⁷");
    EXPECT_EQ(labels_of(ticks), (Labels{"0.0", "0.5", "1.0", "1.5", "2.0", "2.5"}));
    ticks = nice_ticks(-1e150, 1e150, 4);
    EXPECT_EQ(ticks.common, "×10¹⁵⁰");
    EXPECT_EQ(labels_of(ticks), (Labels{"−1.0", "−0.5", "0.0", "0.5", "1.0"}));
    ticks = nice_ticks(5, 5 + 2e-8, 2);
    EXPECT_EQ(ticks.common, "×10⁻⁸ +5");
    EXPECT_EQ(labels_of(ticks), (Labels{"0", "1", "2"}));
}

// Over 60 decades of widths and 12 of offsets: ticks are whole multiples of 1, 2 or 5 · 10^e, as many as asked for, and their labels, read with what
// is common to them, say their values.
TEST(AnnotationTicks, LabelsSayTheValues) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> exponent(-30, 30), share(-1, 1), closeness(0, 12);
    std::uniform_int_distribution<int> count(1, 12);
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 4000 : 20000); ++trial) {
        const double width = std::pow(10.0, exponent(random));
        const double low = share(random) * width * (trial % 3 ? 1 : std::pow(10.0, closeness(random))), high = low + width;
        const int most = count(random);
        const Ticks ticks = nice_ticks(low, high, most);
        const double real = high - low;
        ASSERT_LE(ticks.ticks.size(), static_cast<std::size_t>(most) + 1) << low << " " << high;
        // The step is less than 2.5 times the least that is allowed, so at least this many fit.
        ASSERT_GE(static_cast<double>(ticks.ticks.size()), std::floor(most / 2.5 - 1e-9)) << low << " " << high << " " << most;
        const double largest = std::max(std::abs(low), std::abs(high));
        for (std::size_t i = 0; i < ticks.ticks.size(); ++i) {
            const auto& [value, label] = ticks.ticks[i];
            ASSERT_GE(value, low);
            ASSERT_LE(value, high);
            // Three roundings of the value, or the slack of 1e-9 of a step at an end.
            const long double said = read_label(label, ticks.common);
            ASSERT_NEAR(static_cast<double>(said - value), 0, 1e-15 * largest + 2e-9 * real) << label << " | " << ticks.common << " " << low << " " << high;
            ASSERT_LE(label.size(), 20U);
            if (i >= 2) {
                const double step = value - ticks.ticks[i - 1].value, before = ticks.ticks[i - 1].value - ticks.ticks[i - 2].value;
                ASSERT_NEAR(step, before, 4e-15 * largest + 4e-9 * real);
                const double digit = step / std::pow(10.0, std::floor(std::log10(step * 1.01)));
                const double off = std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)});
                ASSERT_LT(off, 1e-2) << step;  // of a step that is itself a difference of values up to 1e12 times as large
            }
        }
        // A hundredth of the step, which is less than 2.5/most of the range; half of it by rounding.
        ASSERT_NEAR(static_cast<double>(read_label(ticks.low.label, ticks.common)), low, 0.0126 * real / most + 1e-15 * largest);
        ASSERT_NEAR(static_cast<double>(read_label(ticks.high.label, ticks.common)), high, 0.0126 * real / most + 1e-15 * largest);
    }
}

TEST(AnnotationTicks, OfHardlyAnyRangeAreItsEnds) {
    const Ticks constant = nice_ticks(0.1 + 0.2, 0.1 + 0.2, 5);
    EXPECT_TRUE(constant.ticks.empty());
    EXPECT_EQ(constant.low.label, "0.3");
    const double next = std::nextafter(1.0, 2.0);
    const Ticks ulp = nice_ticks(1, next, 5);
    EXPECT_TRUE(ulp.ticks.empty());
    EXPECT_EQ(std::strtod(ulp.high.label.c_str(), nullptr), next);
    EXPECT_TRUE(nice_ticks(0, 1e-310, 5).ticks.empty());
    EXPECT_EQ(nice_ticks(0, 1e-310, 5).high.label, "1×10⁻³¹⁰");
    EXPECT_EQ(nice_ticks(0, 0, 5).low.label, "0");
    EXPECT_EQ(nice_ticks(-1e300, 1e300, 5).common, "×10³⁰⁰");
    EXPECT_TRUE(nice_ticks(-1.5e308, 1.5e308, 5).ticks.empty());
    EXPECT_EQ(nice_ticks(-1.5e308, 1.5e308, 5).low.label, "−1.5×10³⁰⁸");
}

TEST(AnnotationTicks, OfLogarithmicAxes) {
    EXPECT_EQ(labels_of(log_ticks(0.001, 30, 12)), (Labels{"0.001", "0.01", "0.1", "1", "10"}));
    EXPECT_EQ(labels_of(log_ticks(3, 200, 12)), (Labels{"5", "10", "20", "50", "100", "200"}));
    EXPECT_EQ(labels_of(log_ticks(1e-20, 1e20, 5)), (Labels{"1×10⁻²⁰", "1×10⁻¹¹", "0.01", "1×10⁷", "1×10¹⁶"}));
    EXPECT_EQ(labels_of(log_ticks(2, 8, 3)), labels_of(nice_ticks(2, 8, 3)));
}

TEST(AnnotationTicks, NumbersInWords) {
    EXPECT_EQ(number_text(0), "0");
    EXPECT_EQ(number_text(0.25), "0.25");
    EXPECT_EQ(number_text(-3), "−3");
    EXPECT_EQ(number_text(1.23456), "1.235");
    EXPECT_EQ(number_text(101325, 6), "101325");
    EXPECT_EQ(number_text(1.5e-7), "1.5×10⁻⁷");
    EXPECT_EQ(number_text(-6.02214e23), "−6.022×10²³");
    EXPECT_EQ(number_text(0.001), "0.001");
    EXPECT_EQ(number_text(5e-324), "4.941×10⁻³²⁴");
}

class AnnotationText : public testing_support::FolderTest {
protected:
    Font font;
};

// All digits of DejaVu Sans are 1303 of 2048 units wide, its capitals 1493 high: measures of the font (version 2.37), not of FreeType.
TEST_F(AnnotationText, MeasuresAreThoseOfTheFont) {
    for (const double size : {9.0, 13.5, 28.4, 400.0}) {
        EXPECT_NEAR(font.advance("0123456789", size), 10 * 1303.0 / 2048 * size, 1e-9 * size);
        EXPECT_EQ(font.draw("0123456789", size).advance, font.advance("0123456789", size));
        EXPECT_NEAR(font.cap_height(size), 1493.0 / 2048 * size, 1e-9 * size);
        const TextMask h = font.draw("H", size);
        // Hinting moves an edge by at most half a row, anti-aliasing takes the row that is begun.
        EXPECT_NEAR(h.above, font.cap_height(size), 1.5);
        EXPECT_EQ(h.height, h.above) << "stands on the baseline";
        EXPECT_GE(h.left, 0);
        EXPECT_LE(h.left + h.width, std::ceil(h.advance));
    }
    EXPECT_LT(font.advance("AV", 100), font.advance("A", 100) + font.advance("V", 100)) << "kerning";
}

// A black square covers its box: coverage is the area.
TEST_F(AnnotationText, CoverageIsArea) {
    const TextMask square = font.draw("■", 200);
    double area = 0;
    for (const float c : square.coverage) area += c;
    EXPECT_LE(area, square.width * square.height);
    EXPECT_GE(area, (square.width - 2) * (square.height - 2));
    EXPECT_NEAR(square.width, square.height, 2);
    for (const float c : font.draw("Ångström", 12).coverage) EXPECT_TRUE(c >= 0 && c <= 1);
}

TEST_F(AnnotationText, NothingIsDrawnOfNothing) {
    for (const char* text : {"", " ", "   "}) {
        const TextMask mask = font.draw(text, 20);
        EXPECT_EQ(mask.width * mask.height, 0);
        EXPECT_TRUE(mask.coverage.empty());
    }
    EXPECT_EQ(font.advance("", 20), 0);
    EXPECT_EQ(font.advance("a\nb\tc", 20), font.advance("a b c", 20)) << "control characters are spaces";
}

// RFC 3629: a byte that belongs to no character is one U+FFFD.
TEST_F(AnnotationText, WrongBytesAreReplaced) {
    const auto same = [&](const char* wrong, const char* right) {
        EXPECT_EQ(font.draw(wrong, 20).coverage, font.draw(right, 20).coverage) << wrong;
        EXPECT_EQ(font.advance(wrong, 20), font.advance(right, 20)) << wrong;
    };
    same("\xff", "\uFFFD");
    same("a\x80z", "a\uFFFDz");
    same("\xc0\xaf", "\uFFFD\uFFFD");              // overlong
    same("\xe0\x80\xaf", "\uFFFD\uFFFD\uFFFD");
    same("\xed\xa0\x80", "\uFFFD\uFFFD\uFFFD");    // a surrogate
    same("\xf4\x90\x80\x80", "\uFFFD\uFFFD\uFFFD\uFFFD");  // beyond U+10FFFF
    same("\xe2\x82", "\uFFFD\uFFFD");              // cut off
    EXPECT_EQ(font.missing_character("ρ∞ µ [kg/m³] ≤ ≥ …"), "");
    EXPECT_EQ(font.missing_character("a中"), "U+4E2D");
}

TEST_F(AnnotationText, TurnsLeft) {
    const TextMask mask = font.draw("Fin", 30), turned = turned_left(mask);
    ASSERT_EQ(turned.width, mask.height);
    ASSERT_EQ(turned.height, mask.width);
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            // The middle of a pixel from the pen, (u, v), comes to (v, −u).
            const double u = mask.left + x + 0.5, v = y - mask.above + 0.5;
            const int to_x = static_cast<int>(std::floor(v)) - turned.left, to_y = static_cast<int>(std::floor(-u)) + turned.above;
            ASSERT_EQ(turned.at(to_x, to_y), mask.at(x, y));
        }
}

TEST_F(AnnotationText, IsBrokenAtSpacesAndCutWithASign) {
    const std::string text = "All that the picture would show without them is drawn, smaller, into what is left";
    for (const double width : {90.0, 200.0, 2000.0}) {
        std::string joined;
        for (const std::string& line : wrapped(font, text, 14, width)) {
            EXPECT_LE(font.advance(line, 14), width);
            joined += (joined.empty() ? "" : " ") + line;
        }
        EXPECT_EQ(joined, text);
    }
    EXPECT_TRUE(wrapped(font, "  ", 14, 100).empty());
    // No word is left alone in a line, and none is cut that need not be.
    EXPECT_EQ(wrapped(font, "aaaa bbbb cccc dddd", 14, font.advance("aaaa bbbb cccc", 14)), (Labels{"aaaa bbbb", "cccc dddd"}));
    EXPECT_EQ(wrapped(font, "aaaaaaaaaaaa b c", 14, font.advance("aaaaaaaaaaaa", 14)), (Labels{"aaaaaaaaaaaa", "b c"}));
    const std::string cut = shortened(font, "StagnationEnthalpy∞∞∞", 14, 80);
    EXPECT_LE(font.advance(cut, 14), 80);
    EXPECT_EQ(cut.substr(cut.size() - 3), "…");
    EXPECT_GT(font.advance(cut, 14), 80 - font.advance("m", 14)) << "no more is cut than needed";
    EXPECT_EQ(shortened(font, "p", 14, 80), "p");
    EXPECT_EQ(shortened(font, "p", 14, 1), "");
    // A megabyte of one word: cut in less than a second, not character by character.
    EXPECT_LE(font.advance(shortened(font, std::string(CELLPROJ_SANITIZED ? 20000 : 200000, 'm'), 14, 100), 14), 100);
}

TEST_F(AnnotationText, FontsThatAreNoneAreRefused) {
    write("none.ttf", "no font");
    for (const std::filesystem::path& file : {folder_ / "none.ttf", folder_ / "missing.ttf", folder_}) {
        try {
            const Font refused(file, "--font");
            FAIL() << file;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::option);
            EXPECT_EQ(error.place(), "--font");
            EXPECT_NE(error.found().find(file.string()), std::string::npos);
        }
    }
    // Cut off in the middle: refused, or drawn with what is there, never a crash.
    const std::string whole = testing_support::bytes_of(default_font_file());
    for (const std::size_t size : {std::size_t{100}, whole.size() / 50, whole.size() / 3}) {
        try {
            Font(write("cut.ttf", whole.substr(0, size))).draw("Text", 20);
        } catch (const Error&) {
        }
    }
}

}  // namespace
}  // namespace cellproj
