// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation/ticks.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace cellproj {

namespace {

using Whole = std::int64_t;

constexpr int most_digits = 6;              // of a label, before an offset is left out
constexpr double coarsest_plain = 1e6;      // numbers below it and ...
constexpr double finest_plain = 1e-3;       // ... from here are written without a power of ten
constexpr double narrowest_share = 0x1p-43; // of the larger end: 10 ticks, each a hundred float64 from the next

// m · 10^e with whole m; m < 2^53 and |e| ≤ 22 make it the nearest float64, otherwise it is off by an ulp or two.
double decimal(Whole m, int e) { return e < 0 ? static_cast<double>(m) / std::pow(10.0, -e) : static_cast<double>(m) * std::pow(10.0, e); }

int digits_of(Whole m) { return static_cast<int>(std::to_string(std::abs(m)).size()); }

std::string superscript(int number) {
    static const char* const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = number < 0 ? "⁻" : "";
    for (const char digit : std::to_string(std::abs(number))) text += digits[digit - '0'];
    return text;
}

std::string times_ten_to(int exponent) { return "×10" + superscript(exponent); }

// m · 10^e without a power of ten; zeros at the end of the fraction are kept, so that labels of one axis line up.
std::string plain_text(Whole m, int e) {
    std::string digits = std::to_string(std::abs(m));
    if (e > 0 && m != 0) digits.append(static_cast<std::size_t>(e), '0');
    if (e < 0) {
        const auto fraction = static_cast<std::size_t>(-e);
        if (digits.size() <= fraction) digits.insert(0, fraction + 1 - digits.size(), '0');
        digits.insert(digits.size() - fraction, ".");
    }
    return (m < 0 ? "−" : "") + digits;
}

// The same with the shortest fraction.
std::string short_text(Whole m, int e) {
    for (; e < 0 && m % 10 == 0; ++e) m /= 10;
    return plain_text(m, e);
}

// m · 10^e as a number that stands alone, exactly.
std::string lone_text(Whole m, int e) {
    if (m == 0) return "0";
    for (; m % 10 == 0; ++e) m /= 10;
    const int leading = digits_of(m) - 1 + e;  // the power of ten of the first digit
    if (leading >= -3 && leading < 7) return plain_text(m, e);
    return plain_text(m, e - leading) + times_ten_to(leading);
}

// A number of printf's %e to ours.
std::string from_scientific(const char* text) {
    const char* const exponent = std::strchr(text, 'e');
    Whole m = 0;
    int e = std::atoi(exponent + 1);
    bool fraction = false;
    for (const char* c = text; c != exponent; ++c) {
        if (*c == '.') fraction = true;
        if (*c < '0' || *c > '9') continue;
        m = 10 * m + (*c - '0');
        e -= fraction;
    }
    return lone_text(text[0] == '-' ? -m : m, e);
}

// All digits that tell the number from its neighbours.
std::string full_text(double value) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof text - 1, value, std::chars_format::scientific).ptr;
    *end = 0;
    return from_scientific(text);
}

struct Step {
    int mantissa;  // 1, 2 or 5
    int exponent;
};

// The smallest step that is at least `least`, but for rounding: a range of 1e-3 at 1e6 is off by 5e-8 of itself.
Step step_of(double least) {
    int e = static_cast<int>(std::floor(std::log10(least)));
    for (; ; ++e)
        for (const int m : {1, 2, 5})
            if (decimal(m, e) >= least * (1 - 1e-6)) return {m, e};
}

// The one of the numbers first .. last that has the most zeros at its end, the nearest to 0 of several.
Whole roundest(Whole first, Whole last) {
    if (first <= 0 && last >= 0) return 0;
    const bool negative = last < 0;
    const Whole low = negative ? -last : first, high = negative ? -first : last;
    Whole best = low;
    for (Whole power = 10; power <= high; power *= 10) {
        const Whole multiple = (low + power - 1) / power * power;
        if (multiple > high) break;
        best = multiple;
    }
    return negative ? -best : best;
}

}  // namespace

std::string number_text(double value, int digits) {
    assert(std::isfinite(value) && digits >= 1 && digits <= 17);
    char text[40];
    std::snprintf(text, sizeof text, "%.*e", digits - 1, value);
    return from_scientific(text);
}

Ticks nice_ticks(double low, double high, int most) {
    assert(std::isfinite(low) && low <= high && std::isfinite(high) && most >= 1);
    if (low == high) return {{}, {low, number_text(low, most_digits)}, {high, number_text(high, most_digits)}, {}};
    const double largest = std::max(std::abs(low), std::abs(high));
    if (largest > 1e300 || high - low < std::max(narrowest_share * largest, 1e-290)) return {{}, {low, full_text(low)}, {high, full_text(high)}, {}};

    const Step step = step_of((high - low) / most);
    const int e = step.exponent;
    const double width = decimal(step.mantissa, e);
    // A tick that is beyond an end by rounding alone stands at the end.
    const double slack = 1e-9 * width + 0x1p-52 * largest;
    const auto first = static_cast<Whole>(std::ceil((low - slack) / width)), last = static_cast<Whole>(std::floor((high + slack) / width));

    // In units of 10^e from here.
    const Whole m_first = first * step.mantissa, m_last = last * step.mantissa;
    const Whole m_largest = std::max(std::abs(m_first), std::abs(m_last));
    const bool offset_needed = first <= last && digits_of(m_largest) > most_digits;
    const Whole offset = offset_needed ? roundest(m_first, m_last) : 0;
    const double size = std::max(std::abs(low - decimal(offset, e)), std::abs(high - decimal(offset, e)));
    const bool scaled = size >= coarsest_plain || size < finest_plain;
    const int exponent = scaled ? static_cast<int>(std::floor(std::log10(size))) : 0;

    Ticks result;
    for (Whole k = first; k <= last; ++k) {
        const Whole m = k * step.mantissa;
        result.ticks.push_back({std::clamp(decimal(m, e), low, high), plain_text(m - offset, e - exponent)});
    }
    const auto end = [&](double value) -> Tick {
        // Differences to the offset are exact where it matters: both are close to each other.
        const double hundredths = (value - decimal(offset, e)) / decimal(1, e - 2);
        const auto m = static_cast<Whole>(std::llround(hundredths));
        // Zeros at the end stay where they say that the end was rounded.
        const bool whole = std::abs(hundredths - static_cast<double>(m)) <= 1e-6 + 0x1p-51 * largest / decimal(1, e - 2);
        return {value, whole ? short_text(m, e - 2 - exponent) : plain_text(m, e - 2 - exponent)};
    };
    result.low = end(low);
    result.high = end(high);
    if (!result.ticks.empty() && result.ticks.front().value - low <= slack) result.low.label = result.ticks.front().label;
    if (!result.ticks.empty() && high - result.ticks.back().value <= slack) result.high.label = result.ticks.back().label;
    if (exponent != 0) result.common = times_ten_to(exponent);
    if (offset != 0) {
        result.common += (result.common.empty() ? "" : " ") + std::string(offset > 0 ? "+" : "") + lone_text(offset, e);
    }
    return result;
}

Ticks log_ticks(double low, double high, int most) {
    assert(1e-300 <= low && low <= high && high <= 1e300 && most >= 1);
    // An end that is a power of ten but for rounding counts as one.
    const int first = static_cast<int>(std::ceil(std::log10(low) - 1e-12)), last = static_cast<int>(std::floor(std::log10(high) + 1e-12));
    if (last - first < 1) return nice_ticks(low, high, most);
    const int decades = last - first + 1, every = (decades + most - 1) / most;
    Ticks result{{}, {low, number_text(low)}, {high, number_text(high)}, {}};
    const bool finer = 3 * decades <= most;
    for (int e = finer ? first - 1 : first; e <= last; e += every)
        for (const int m : {1, 2, 5}) {
            if (m > 1 && !finer) break;
            const double value = decimal(m, e);
            if (value >= low * (1 - 1e-12) && value <= high * (1 + 1e-12)) result.ticks.push_back({std::clamp(value, low, high), lone_text(m, e)});
        }
    return result;
}

}  // namespace cellproj
