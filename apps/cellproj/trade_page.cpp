// SPDX-License-Identifier: BSD-3-Clause
//
// The page of `cellproj trade`: plot, table, pictures and error maps in one HTML file.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "trade_report.hpp"

namespace cellproj::cli {

namespace {

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
    return "<img alt=\"" + html_escaped(title) + "\" title=\"" + html_escaped(title) + "\" src=\"data:image/png;base64," +
           base64(encode_png(image)) + "\">";
}

// A picture of judged pixels, the others around them as the nearest of them (in steps to one of four neighbours): points
// on white show nothing. Not further than a sample as even as ours leaves holes.
Image spread(const Image& image, std::span<const PixelTruth> truths) {
    const double area = static_cast<double>(image.width) * image.height;
    const auto furthest = truths.size() == 0 ? 0 : static_cast<int>(3.0 * std::sqrt(area / static_cast<double>(truths.size())));
    Image result = image;
    Image steps(image.width, image.height);  // in x: 1 + how far a judged pixel is; 0: nobody has come here
    std::vector<PixelId> front;
    for (const PixelTruth& truth : truths) {
        steps.at(truth.pixel.x, truth.pixel.y).x = 1;
        front.push_back(truth.pixel);
    }
    for (std::size_t i = 0; i < front.size(); ++i) {
        const PixelId from = front[i];
        const float far = steps.at(from.x, from.y).x;
        for (const PixelId to : {PixelId{from.x + 1, from.y}, {from.x - 1, from.y}, {from.x, from.y + 1}, {from.x, from.y - 1}}) {
            const bool inside = to.x >= 0 && to.x < image.width && to.y >= 0 && to.y < image.height;
            if (!inside || steps.at(to.x, to.y).x > 0 || far > static_cast<float>(furthest)) continue;
            steps.at(to.x, to.y).x = far + 1;
            result.at(to.x, to.y) = result.at(from.x, from.y);
            front.push_back(to);
        }
    }
    return result;
}

std::string table(std::span<const TradeRow> rows) {
    std::string html =
        "<table><tr><th>method<th>backend<th>frame [ms]<th>set-up [ms]<th>tables [kB]<th>RMS<th>99 %<th>max<th>max, opacity<th>front</tr>\n";
    for (const TradeRow& row : rows) {
        const ErrorMeasure& color = row.error.color;
        html += std::string("<tr") + (row.on_front ? " class=front" : "") + "><td>" + html_escaped(row.name) + "<td>" + html_escaped(row.backend) + "<td>" +
                formatted("%.1f", row.frame_ms) + "<td>" + formatted("%.2f", row.set_up_ms) + "<td>" +
                formatted("%.0f", static_cast<double>(row.table_bytes) / 1000) + "<td>" + formatted("%.2e", color.rms) + "<td>" +
                formatted("%.2e", color.percentile_99) + "<td>" + formatted("%.2e", color.maximum) + "<td>" +
                formatted("%.2e", row.error.opacity.maximum) + "<td>" + (row.on_front ? "★" : "") + "</tr>\n";
    }
    return html + "</table>\n";
}

// The colours of the error maps, from the maps themselves: 41 steps from 1e-5 to 1e-1.
std::string legend() {
    constexpr int steps = 41;
    Image errors(steps, 1);
    std::vector<PixelTruth> truths;
    for (int i = 0; i < steps; ++i) {
        errors.at(i, 0).r = static_cast<float>(std::pow(10.0, -5.0 + 4.0 * i / (steps - 1)));
        truths.push_back({{i, 0}, {}, {}, {}});
    }
    return "<p class=legend>1e-5 " + picture(error_map(errors, truths), "1e-5 to 1e-1, logarithmic") + " 1e-1</p>\n";
}

std::string pair_of(const std::string& first, const std::string& second, const std::string& caption) {
    return "<figure>" + first + second + "<figcaption>" + html_escaped(caption) + "</figcaption></figure>\n";
}

constexpr const char* style =
    "<style>body{font:15px/1.5 system-ui,sans-serif;max-width:1040px;margin:2em auto;padding:0 1em;color:#222;background:#fff}"
    "table{border-collapse:collapse;font-variant-numeric:tabular-nums}td,th{padding:.15em .8em;text-align:right;border-bottom:1px solid #ddd}"
    "td:first-child,th:first-child{text-align:left}tr.front{background:#eaf4ea}.front td:last-child{color:#1a7f37}svg{width:100%;height:auto}"
    "figure{display:inline-block;width:500px;max-width:100%;margin:.5em .2em;vertical-align:top;text-align:center}"
    "figure img{width:49%;border:1px solid #ddd}figcaption{font-size:13px}"
    ".legend img{width:300px;height:14px;vertical-align:middle;border:1px solid #ddd}</style>\n";

}  // namespace

std::string to_html(const TradeReport& report) {
    std::string html = "<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><meta name=viewport content=\"width=device-width\">"
                       "<title>cellproj trade: " + html_escaped(report.scene) + "</title>\n" + style +
                       "<h1>Time and error of every method</h1>\n<p>" + html_escaped(report.scene) + ". " +
                       html_escaped(report.judged_in_words()) + " judged by rays in float64; times: " + report.timed_in_words() +
                       ", " + html_escaped(report.backend) +
                       ". Errors are those of colour channels, 0 … 1. Green: nothing else is both faster and more accurate.</p>\n";
    html += to_svg(report.rows) + table(report.rows);
    const auto shown = [&](const Image& image) { return report.whole_picture ? image : spread(image, report.truths); };
    html += std::string("<h2>Pictures and errors</h2>\n<p>The largest error of a channel in each pixel, logarithmic; white: not judged") +
            (report.whole_picture ? "" : ". Pixels between judged ones are shown as the nearest of them") + ".</p>\n" + legend() +
            pair_of(picture(shown(report.truth), "truth"), "", "the truth, by rays in float64");
    for (const TradeRow& row : report.rows) {
        const std::string name = row.name;
        html += pair_of(picture(row.image, name), picture(shown(error_map(row.image, report.truths)), "error of " + name),
                        name + ": RMS " + formatted("%.1e", row.error.color.rms) + ", max " + formatted("%.1e", row.error.color.maximum));
    }
    return html + "</html>\n";
}

}  // namespace cellproj::cli
