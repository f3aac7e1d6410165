// SPDX-License-Identifier: BSD-3-Clause
//
// The plot of `cellproj trade`: time against error, both logarithmic, as SVG.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "trade_report.hpp"

namespace cellproj::cli {

namespace {

constexpr double width = 960, height = 600, left = 90, right = 20, top = 20, bottom = 60;
constexpr double label_size = 11, letter = 6.1;  // [px]; the mean width of a letter of a sans-serif of that size

std::string at(double place) { return formatted("%.1f", place); }

// 2e-05 is 2e-5 to a reader.
std::string tick_text(double value) {
    if (value >= 0.01 && value < 1e5) return formatted("%g", value);
    std::string text = formatted("%.0e", value);
    const std::size_t sign = text.find('e') + 1;
    if (text[sign] == '+') text.erase(sign, 1);
    const std::size_t digits = text.find_first_of("0123456789", sign);
    text.erase(digits, std::min(text.find_first_not_of('0', digits), text.size() - 1) - digits);
    return text;
}

// A logarithmic axis from `low` to `high` over `begin` .. `end` of the drawing.
struct Axis {
    double low, high, begin, end;

    double place(double value) const {
        return begin + (end - begin) * std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    }
};

// Values that are 0 or below `least` stand at the low end, those that are not finite at the high one.
Axis axis_over(std::vector<double> values, double least, double begin, double end) {
    std::erase_if(values, [](double v) { return !(v > 0.0) || !std::isfinite(v); });
    if (values.empty()) values.push_back(least);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {std::max(*low, least) / 1.5, std::max(*high, least) * 1.5, begin, end};
}

// One tick per power of ten; at 1, 2, 5 where that would be fewer than three; at all digits where those would be.
std::vector<double> ticks(const Axis& axis) {
    const double span = axis.high / axis.low;
    const int step = span < 6 ? 1 : 10;
    std::vector<double> result;
    for (int power = static_cast<int>(std::floor(std::log10(axis.low))); power <= std::log10(axis.high); ++power) {
        for (int digit = 1; digit < 10; ++digit) {
            const bool wanted = digit == 1 || digit % step == 0 || (span < 1000 && (digit == 2 || digit == 5));
            const double value = digit * std::pow(10.0, power);
            if (wanted && value >= axis.low && value <= axis.high) result.push_back(value);
        }
    }
    return result;
}

std::string line(double x1, double y1, double x2, double y2, const char* color = "#e4e4e4") {
    return "<line stroke=\"" + std::string(color) + "\" x1=\"" + at(x1) + "\" y1=\"" + at(y1) + "\" x2=\"" + at(x2) + "\" y2=\"" + at(y2) + "\"/>\n";
}

std::string text(double x, double y, const char* anchor, const char* color, double size, const std::string& words,
                 const std::string& more = "") {
    return "<text text-anchor=\"" + std::string(anchor) + "\" fill=\"" + color + "\" font-size=\"" + formatted("%g", size) +
           "\" x=\"" + at(x) + "\" y=\"" + at(y) + "\"" + more + ">" + html_escaped(words) + "</text>\n";
}

std::string grid(const Axis& x, const Axis& y) {
    const double floor = height - bottom, middle = (top + floor) / 2;
    std::string svg;
    for (const double value : ticks(x)) {
        svg += line(x.place(value), top, x.place(value), floor);
        svg += text(x.place(value), floor + 18, "middle", "#444", 12, tick_text(value));
    }
    for (const double value : ticks(y)) {
        svg += line(left, y.place(value), width - right, y.place(value));
        svg += text(left - 8, y.place(value) + 4, "end", "#444", 12, tick_text(value));
    }
    svg += "<rect fill=\"none\" stroke=\"#888\" x=\"" + at(left) + "\" y=\"" + at(top) + "\" width=\"" + at(width - right - left) +
           "\" height=\"" + at(floor - top) + "\"/>\n";
    svg += text((left + width - right) / 2, height - 14, "middle", "#222", 13, "time of a frame, median [ms]");
    return svg + text(22, middle, "middle", "#222", 13, "RMS error of the colours (0 … 1)",
                      " transform=\"rotate(-90 22 " + at(middle) + ")\"");
}

struct Box {
    double x0, y0, x1, y1;

    bool overlaps(const Box& other) const { return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1; }
};

struct Point {
    double x, y;
};

// Places labels one after another where no label and no point is, with a line to the point where they are not beside it; those that
// find no place are left out.
class Labels {
public:
    explicit Labels(const std::vector<Point>& points) {
        for (const Point& p : points) taken_.push_back({p.x - 5, p.y - 5, p.x + 5, p.y + 5});
    }

    std::string add(Point p, const std::string& words, const char* color) {
        const double wide = letter * static_cast<double>(words.size());
        static constexpr std::array<double, 7> rises{4, -7, 15, -18, 26, -29, 37};  // of the baseline below the point
        for (const double rise : rises) {
            for (const bool to_the_right : {true, false}) {
                const double x0 = to_the_right ? p.x + 8 : p.x - 8 - wide;
                const Box box{x0, p.y + rise - 9, x0 + wide, p.y + rise + 2};
                if (!is_free(box)) continue;
                taken_.push_back(box);
                const bool beside = rise > -10 && rise < 10;
                const std::string lead =
                    beside ? "" : line(p.x, p.y, to_the_right ? x0 - 1 : x0 + wide + 1, p.y + rise - 4, "#bbb");
                return lead + text(to_the_right ? x0 : x0 + wide, p.y + rise, to_the_right ? "start" : "end", color, label_size, words);
            }
        }
        return "";
    }

private:
    bool is_free(const Box& box) const {
        return box.x0 > left && box.x1 < width - right && box.y0 > top && box.y1 < height - bottom &&
               std::none_of(taken_.begin(), taken_.end(), [&](const Box& other) { return box.overlaps(other); });
    }

    std::vector<Box> taken_;
};

}  // namespace

std::string to_svg(std::span<const TradeRow> rows) {
    std::vector<double> times, errors;
    for (const TradeRow& row : rows) {
        times.push_back(row.frame_ms);
        errors.push_back(row.error.color.rms);
    }
    const Axis x = axis_over(times, 1e-3, left, width - right);
    const Axis y = axis_over(errors, 1e-9, height - bottom, top);
    std::vector<Point> points;
    std::string front, marks, names;
    for (const TradeRow& row : rows) {
        const Point p = points.emplace_back(Point{x.place(row.frame_ms), y.place(row.error.color.rms)});
        if (row.on_front) front += at(p.x) + "," + at(p.y) + " ";
        marks += "<circle fill=\"" + std::string(row.on_front ? "#1a7f37" : "#999") + "\" r=\"" + (row.on_front ? "5" : "4") +
                 "\" cx=\"" + at(p.x) + "\" cy=\"" + at(p.y) + "\"><title>" + html_escaped(row.name) + ": " +
                 formatted("%.1f", row.frame_ms) + " ms, RMS " + formatted("%.1e", row.error.color.rms) + "</title></circle>\n";
    }
    Labels labels(points);
    for (const bool on_front : {true, false}) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i].on_front == on_front) names += labels.add(points[i], rows[i].name, on_front ? "#0f5223" : "#666");
        }
    }
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" font-family=\"system-ui, sans-serif\" viewBox=\"0 0 " + at(width) + " " +
           at(height) + "\">\n" + grid(x, y) + "<polyline fill=\"none\" stroke=\"#1a7f37\" stroke-dasharray=\"4 4\" points=\"" +
           front + "\"/>\n" + marks + names + "</svg>\n";
}

}  // namespace cellproj::cli
