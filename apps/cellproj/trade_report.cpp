// SPDX-License-Identifier: BSD-3-Clause
#include "trade_report.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace cellproj::cli {

namespace {

// printf into a string; lines are short.
[[gnu::format(printf, 1, 2)]] std::string line(const char* format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

// As statistics say (render/statistics.hpp).
const char* drawn_as(const TradeRow& row) { return row.sampling ? "grid" : "tetrahedra"; }
std::string sampling(const TradeRow& row) { return row.sampling ? to_string(*row.sampling) : ""; }

}  // namespace

std::string formatted(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string html_escaped(const std::string& text) {
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

std::string TradeReport::judged_in_words() const {
    return whole_picture ? "all " + std::to_string(judged) + " pixels that see the mesh"
                         : std::to_string(judged) + " pixels, evenly drawn,";
}

std::string TradeReport::timed_in_words() const {
    return rounds == 1 ? "one frame each" : "medians of " + std::to_string(rounds) + " frames";
}

std::string to_table(const TradeReport& report) {
    int wide = 26;
    for (const TradeRow& row : report.rows) wide = std::max(wide, static_cast<int>(row.name.size()));
    std::string text = line("%-*s %-9s %9s %10s %9s  %9s %9s %9s %9s\n", wide, "method", "backend", "frame ms", "set-up ms", "tables kB", "RMS", "99 %",
                            "max", "max alpha");
    for (const TradeRow& row : report.rows) {
        const ErrorMeasure& color = row.error.color;
        text += line("%-*s %-9s %9.1f %10.2f %9.0f  %9.2e %9.2e %9.2e %9.2e%s\n", wide, row.name.c_str(), row.backend.c_str(), row.frame_ms,
                     row.set_up_ms, static_cast<double>(row.table_bytes) / 1000, color.rms, color.percentile_99, color.maximum,
                     row.error.opacity.maximum, row.on_front ? " *" : "");
    }
    return text + line("* nothing else is both faster and more accurate (RMS). %s judged, %s, %s\n",
                       report.judged_in_words().c_str(), report.timed_in_words().c_str(), report.backend.c_str());
}

std::string to_csv(const TradeReport& report) {
    std::string text = "method,target,backend,frame_ms,set_up_ms,table_bytes,rms,percentile_99,maximum,opacity_rms,opacity_maximum,on_front,iso_method,drawn_as,sampling\n";
    for (const TradeRow& row : report.rows) {
        text += line("%s,%s,%s,%.3f,%.3f,%zu,%.6e,%.6e,%.6e,%.6e,%.6e,%d,%s,%s,%s\n", to_string(row.quality.method).c_str(),
                     to_string(row.quality.target).c_str(), row.backend.c_str(), row.frame_ms, row.set_up_ms, row.table_bytes, row.error.color.rms, row.error.color.percentile_99,
                     row.error.color.maximum, row.error.opacity.rms, row.error.opacity.maximum, row.on_front ? 1 : 0,
                     to_string(row.quality.surfaces).c_str(), drawn_as(row), sampling(row).c_str());
    }
    return text;
}

std::string to_json(const TradeReport& report) {
    using Json = nlohmann::ordered_json;
    const auto measure = [](const ErrorMeasure& m) {
        return Json{{"rms", m.rms}, {"percentile_99", m.percentile_99}, {"maximum", m.maximum}};
    };
    Json rows = Json::array();
    for (const TradeRow& row : report.rows) {
        rows.push_back({{"method", to_string(row.quality.method)},
                        {"target", to_string(row.quality.target)},
                        {"iso_method", to_string(row.quality.surfaces)},
                        {"drawn_as", drawn_as(row)},
                        {"sampling", row.sampling ? Json(sampling(row)) : Json(nullptr)},
                        {"backend", row.backend},
                        {"ms", {{"set_up", row.set_up_ms}, {"frame", row.frame_ms}}},
                        {"table_bytes", row.table_bytes},
                        {"error", {{"color", measure(row.error.color)}, {"opacity", measure(row.error.opacity)}}},
                        {"on_front", row.on_front}});
    }
    return Json{{"scene", report.scene},
                {"backend", report.backend},
                {"judged_pixels", report.judged},
                {"whole_picture", report.whole_picture},
                {"rounds", report.rounds},
                {"methods", std::move(rows)}}
        .dump(2, ' ', false, Json::error_handler_t::replace);  // names of files need not be UTF-8
}

}  // namespace cellproj::cli
