// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/frames_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace cellproj::bench {

namespace {

std::string number(const char* format, double value) {
    if (std::isnan(value)) return "";
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

// Frames of this row in the time of one of VTK's fastest mapper; nothing where VTK did not take part.
double times_vtk(const std::vector<Row>& rows, const Row& row) {
    double fastest = unknown;
    for (const Row& other : rows) {
        const bool same = other.scene == row.scene && other.transfer == row.transfer && other.projection == row.projection &&
                          other.size == row.size && other.threads == row.threads;
        if (same && other.contender.starts_with("vtk-")) fastest = std::fmin(fastest, other.frame_ms);
    }
    return fastest / row.frame_ms;
}

struct Column {
    const char* name;
    bool text;  // left-aligned
    std::function<std::string(const Row&)> value;
};

// `brief`: a few digits for the eye; else as many as were measured.
std::vector<Column> columns(const std::vector<Row>& rows, bool brief) {
    const char *ms = brief ? "%.1f" : "%.3f", *count = brief ? "%.3g" : "%.0f", *error = brief ? "%.1e" : "%.6e";
    const auto real = [](const char* name, const char* format, double Row::*member) {
        return Column{name, false, [=](const Row& row) { return number(format, row.*member); }};
    };
    return {{"scene", true, [](const Row& row) { return row.scene; }},
            {"tets", false, [](const Row& row) { return std::to_string(row.cells); }},
            {"transfer", true, [](const Row& row) { return row.transfer; }},
            {"projection", true, [](const Row& row) { return row.projection; }},
            {"size", false, [](const Row& row) { return std::to_string(row.size); }},
            {"contender", true, [](const Row& row) { return row.contender; }},
            {"threads", false, [=](const Row& row) { return brief && row.threads == 0 ? "all" : std::to_string(row.threads); }},
            real("set_up_ms", brief ? "%.0f" : ms, &Row::set_up_ms),
            real("first_ms", brief ? "%.0f" : ms, &Row::first_ms),
            real("frame_ms", ms, &Row::frame_ms),
            real("user_ms", ms, &Row::user_ms),
            real("sort_ms", ms, &Row::sort_ms),
            real("project_ms", ms, &Row::project_ms),
            real("draw_ms", ms, &Row::draw_ms),
            real("fragments", count, &Row::fragments),
            {"pixels_per_tet", false,
             [](const Row& row) { return number("%.1f", row.fragments / static_cast<double>(row.cells)); }},
            {"peak_mb", false, [](const Row& row) { return number("%.0f", row.peak_bytes / 1e6); }},
            {"bytes_per_tet", false,
             [](const Row& row) { return number("%.0f", row.peak_bytes / static_cast<double>(row.cells)); }},
            real("rms", error, &Row::rms),
            real("max", error, &Row::maximum),
            {"times_vtk", false, [&rows](const Row& row) { return number("%.2f", times_vtk(rows, row)); }},
            {"failure", true, [](const Row& row) { return row.failure; }}};
}

using Cells = std::vector<std::string>;

// The names of the columns, then a line for each row; without the columns that hold nothing.
std::vector<Cells> brief_cells(const std::vector<Row>& rows, std::vector<bool>& is_text) {
    std::vector<Cells> lines(rows.size() + 1);
    for (const Column& column : columns(rows, true)) {
        Cells values;
        for (const Row& row : rows) values.push_back(column.value(row));
        if (std::all_of(values.begin(), values.end(), [](const std::string& v) { return v.empty(); })) continue;
        is_text.push_back(column.text);
        lines[0].push_back(column.name);
        for (std::size_t i = 0; i < values.size(); ++i) lines[i + 1].push_back(values[i]);
    }
    return lines;
}

std::string quoted(const std::string& value) {
    if (value.find_first_of(",\"\n") == value.npos) return value;
    std::string text = "\"";
    for (const char c : value) text += c == '"' ? "\"\"" : std::string(1, c);
    return text + "\"";
}

}  // namespace

std::string to_table(const std::vector<Row>& rows) {
    std::vector<bool> is_text;
    const auto lines = brief_cells(rows, is_text);
    std::vector<std::size_t> widths(is_text.size());
    for (const Cells& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
    std::string text;
    for (const Cells& line : lines) {
        std::string padded;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const std::string space(widths[i] - line[i].size(), ' ');
            padded += (i ? "  " : "") + (is_text[i] ? line[i] + space : space + line[i]);
        }
        padded.erase(padded.find_last_not_of(' ') + 1);
        text += padded + "\n";
    }
    return text;
}

std::string to_markdown(const std::vector<Row>& rows) {
    std::vector<bool> is_text;
    const auto lines = brief_cells(rows, is_text);
    std::string text;
    for (const Cells& line : lines) {
        for (const std::string& cell : line) text += "| " + cell + " ";
        text += "|\n";
        if (&line != &lines.front()) continue;
        for (const bool left : is_text) text += left ? "|---" : "|--:";
        text += "|\n";
    }
    return text;
}

std::string to_csv(const std::vector<Row>& rows) {
    const auto all = columns(rows, false);
    std::string text;
    for (const Column& column : all) text += (text.empty() ? "" : ",") + std::string(column.name);
    text += "\n";
    for (const Row& row : rows) {
        for (std::size_t i = 0; i < all.size(); ++i) text += (i ? "," : "") + quoted(all[i].value(row));
        text += "\n";
    }
    return text;
}

}  // namespace cellproj::bench
