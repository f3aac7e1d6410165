// SPDX-License-Identifier: BSD-3-Clause
//
// Where an axis has ticks and what stands beside them. Steps are 1, 2 or 5 times a power of ten; labels are made from whole
// numbers, so that a label says the decimal of its tick exactly.
#pragma once

#include <string>
#include <vector>

namespace cellproj {

struct Tick {
    double value;       // within low..high; the float64 nearest to the decimal, or the end of the range where that is a rounding away
    std::string label;  // UTF-8, − for minus
};

// The number of a label v is  v · 10^exponent + offset.
struct Ticks {
    std::vector<Tick> ticks;  // ascending
    Tick low, high;           // the ends themselves, their labels rounded to a hundredth of the step
    // What the labels leave out, as it is written once above the axis: "×10⁻⁷", "+1000000", "×10⁻⁷ +5"; mostly empty.
    std::string common;
};

// At most `most` + 1 ticks (most ≥ 1) over finite low ≤ high. The step is the smallest of 1, 2, 5 · 10^e that
// is at least (high − low)/most. Labels that would need more than six digits leave an offset out, numbers from 1e6 and below 1e-3
// a power of ten. No ticks, but ends in full digits, where the range is too narrow for float64 to tell ten ticks apart or
// narrower than 1e-290, or where an end is beyond 1e300; low = high gives the ends alone, to six digits.
Ticks nice_ticks(double low, double high, int most);

// The same for an axis of ln s, 0 < low ≤ high, 1e-300 ≤ low: powers of ten, with 2 and 5 times of them where there is room, or every second,
// third … one where there are many. Ranges that hold fewer than two powers of ten get nice_ticks.
Ticks log_ticks(double low, double high, int most);

// A number in words of at most `digits` digits: "0.25", "1.5×10⁻⁷", "−3". Finite.
std::string number_text(double value, int digits = 4);

}  // namespace cellproj
