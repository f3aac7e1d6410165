// SPDX-License-Identifier: BSD-3-Clause
//
// What `cellproj trade` measured, as a table for the terminal, CSV, JSON, and a page that holds all it shows.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "render/trade.hpp"

namespace cellproj::cli {

struct TradeReport {
    std::string scene;             // what was drawn, in words
    std::size_t judged = 0;        // pixels
    bool whole_picture = false;    // whether these are all that see the mesh
    int rounds = 0;
    std::string backend;           // backend and version
    std::span<const TradeRow> rows;  // by frame time, ascending
    Image truth;                   // of the judged pixels
    std::span<const PixelTruth> truths;

    std::string judged_in_words() const;  // "all 4312 pixels that see the mesh"
    std::string timed_in_words() const;   // "medians of 5 frames"
};

std::string to_table(const TradeReport& report);
std::string to_csv(const TradeReport& report);
std::string to_json(const TradeReport& report);
// Needs nothing but itself: pictures and error maps are within, the plot is SVG.
std::string to_html(const TradeReport& report);
// The plot alone: a well-formed document.
std::string to_svg(std::span<const TradeRow> rows);

// One number by printf.
std::string formatted(const char* format, double value);
// For HTML and SVG, in attributes too.
std::string html_escaped(const std::string& text);

}  // namespace cellproj::cli
