// SPDX-License-Identifier: BSD-3-Clause
//
// The page of `cellproj trade`: table, plot, pictures and error maps in one HTML file.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "trade_report.hpp"

namespace cellproj::cli {

namespace {

std::string number(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '<') result += "&lt;";
        else if (c == '>') result += "&gt;";
        else if (c == '&') result += "&amp;";
        else if (c == '"') result += "&quot;";
        else result += c;
    }
    return result;
}

// RFC 4648 §4.
std::string base64(const std::string& bytes) {
    static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63U] : '=';
    }
    return text;
}

std::string picture(const Image& image, const std::string& title) {
    return "<img alt=\"" + escaped(title) + "\" title=\"" + escaped(title) + "\" src=\"data:image/png;base64," +
           base64(encode_png(image)) + "\">";
}

// A logarithmic axis from `low` to `high` over `begin` .. `end` of the drawing.
struct Axis {
    double low, high, begin, end;

    double at(double value) const {
        return begin + (end - begin) * std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    }
};

Axis axis_over(std::vector<double> values, double least, double begin, double end) {
    std::erase_if(values, [](double v) { return !(v > 0.0) || !std::isfinite(v); });
    if (values.empty()) values.push_back(least);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return {std::max(*low, least) / 1.5, std::max(*high, least) * 1.5, begin, end};
}

constexpr double width = 900, height = 520, left = 80, right = 30, top = 20, bottom = 50;

// One tick per power of ten, or at 1, 2, 5 where that would be fewer than three.
std::vector<double> ticks(const Axis& axis) {
    const bool dense = axis.high / axis.low < 1000;
    std::vector<double> result;
    for (int power = static_cast<int>(std::floor(std::log10(axis.low))); power <= std::log10(axis.high); ++power) {
        for (const double digit : {1.0, 2.0, 5.0}) {
            const double value = digit * std::pow(10.0, power);
            if ((dense || digit == 1.0) && value >= axis.low && value <= axis.high) result.push_back(value);
        }
    }
    return result;
}

std::string grid(const Axis& x, const Axis& y) {
    std::string svg;
    for (const double value : ticks(x)) {
        const std::string at = number("%.1f", x.at(value));
        svg += "<line class=grid x1=" + at + " x2=" + at + " y1=" + number("%.0f", top) + " y2=" + number("%.0f", height - bottom) + " />";
        svg += "<text text-anchor=middle x=" + at + " y=" + number("%.0f", height - bottom + 18) + ">" + number("%g", value) + "</text>";
    }
    for (const double value : ticks(y)) {
        const std::string at = number("%.1f", y.at(value));
        svg += "<line class=grid x1=" + number("%.0f", left) + " x2=" + number("%.0f", width - right) + " y1=" + at + " y2=" + at + " />";
        svg += "<text text-anchor=end x=" + number("%.0f", left - 6) + " y=" + number("%.1f", y.at(value) + 4) + ">" + number("%.0e", value) + "</text>";
    }
    return svg + "<text text-anchor=middle x=" + number("%.0f", (left + width - right) / 2) + " y=" + number("%.0f", height - 8) +
           ">frame [ms]</text><text text-anchor=middle transform=\"translate(16 " + number("%.0f", height / 2) +
           ") rotate(-90)\">RMS error of the colours</text>";
}

std::string plot(std::span<const TradeRow> rows) {
    std::vector<double> times, errors;
    for (const TradeRow& row : rows) {
        times.push_back(row.frame_ms);
        errors.push_back(row.error.color.rms);
    }
    const Axis x = axis_over(times, 1e-3, left, width - right);
    const Axis y = axis_over(errors, 1e-9, height - bottom, top);
    std::string svg = "<svg viewBox=\"0 0 " + number("%.0f", width) + " " + number("%.0f", height) + "\">" + grid(x, y);
    std::string front;
    for (const TradeRow& row : rows) {
        const std::string px = number("%.1f", x.at(row.frame_ms)), py = number("%.1f", y.at(row.error.color.rms));
        if (row.on_front) front += px + "," + py + " ";
        svg += "<circle class=" + std::string(row.on_front ? "front" : "other") + " r=5 cx=" + px + " cy=" + py + " />";
        svg += "<text class=label x=" + number("%.1f", x.at(row.frame_ms) + 8) + " y=" + number("%.1f", y.at(row.error.color.rms) - 6) +
               ">" + escaped(to_string(row.quality.method)) + "</text>";
    }
    return svg + "<polyline class=front points=\"" + front + "\" /></svg>\n";
}

std::string table(std::span<const TradeRow> rows) {
    std::string html =
        "<table><tr><th>method<th>frame [ms]<th>set-up [ms]<th>tables [kB]<th>RMS<th>99 %<th>max<th>max, opacity</tr>\n";
    for (const TradeRow& row : rows) {
        const ErrorMeasure& color = row.error.color;
        html += std::string("<tr") + (row.on_front ? " class=front" : "") + "><td>" + escaped(to_string(row.quality.method)) + "<td>" +
                number("%.1f", row.frame_ms) + "<td>" + number("%.2f", row.set_up_ms) + "<td>" +
                number("%.0f", static_cast<double>(row.table_bytes) / 1000) + "<td>" + number("%.2e", color.rms) + "<td>" +
                number("%.2e", color.percentile_99) + "<td>" + number("%.2e", color.maximum) + "<td>" +
                number("%.2e", row.error.opacity.maximum) + "</tr>\n";
    }
    return html + "</table>\n";
}

constexpr const char* style =
    "<style>body{font:15px/1.5 system-ui,sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.15em .8em;text-align:right;border-bottom:1px solid #ddd}"
    "td:first-child,th:first-child{text-align:left}tr.front{background:#eaf4ea}svg{width:100%;font-size:12px}"
    "circle.front{fill:#1a7f37}circle.other{fill:#999}polyline.front{fill:none;stroke:#1a7f37;stroke-dasharray:4 4}"
    ".grid{stroke:#eee}.label{font-size:11px;fill:#444}figure{display:inline-block;margin:.5em;text-align:center}"
    "img{width:230px;max-width:100%;image-rendering:pixelated;border:1px solid #ddd}</style>\n";

}  // namespace

std::string to_html(const TradeReport& report) {
    std::string html = "<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><title>cellproj trade: " + escaped(report.scene) +
                       "</title>\n" + style + "<h1>Time and error of every method</h1>\n<p>" + escaped(report.scene) + ". " +
                       std::to_string(report.judged) + " pixels judged by rays in float64; times are medians of " +
                       std::to_string(report.rounds) + " frames, " + escaped(report.backend) +
                       ". Green: nothing else is both faster and more accurate.</p>\n";
    html += plot(report.rows) + table(report.rows);
    html += "<h2>Pictures and errors</h2>\n<p>Errors from 1e-5 (dark blue) to 1e-1 (yellow), logarithmic; pixels that were not judged "
            "are white.</p>\n<figure>" +
            picture(report.truth, "truth") + "<figcaption>truth</figcaption></figure>\n";
    for (const TradeRow& row : report.rows) {
        const std::string name = to_string(row.quality.method);
        html += "<figure>" + picture(row.image, name) + picture(error_map(row.image, report.truths), "error of " + name) +
                "<figcaption>" + escaped(name) + ": RMS " + number("%.1e", row.error.color.rms) + ", max " +
                number("%.1e", row.error.color.maximum) + "</figcaption></figure>\n";
    }
    return html + "</html>\n";
}

}  // namespace cellproj::cli
