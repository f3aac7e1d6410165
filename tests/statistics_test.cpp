// SPDX-License-Identifier: BSD-3-Clause
//
// The statistics file: others read its keys, so they are held here one by one.
#include "render/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace cellproj {
namespace statistics_test {

using Json = nlohmann::json;

TEST(Statistics, EveryNumberStandsUnderItsKey) {
    RunStatistics run;
    run.once_ms = {.read = 1.5, .tetrahedralize = 2.5, .prepare = 3.5};
    run.peak_memory_bytes = 123456789012;
    Statistics picture;
    picture.ms = {.plan = 1, .sort = 2, .project = 3, .draw = 4, .read_back = 5, .total = 6, .write = 7};
    picture.counts = {.cells = 11, .culled = 12, .drawn = 13, .triangles = 14, .fragments = 22, .unordered = 15, .cycles = 17,
                      .split_cells = 18, .order_violations = 16};
    picture.drawn_as = "grid";
    picture.method = "preint3d:64";
    picture.target = "rgba16f";
    picture.table_bytes = 4194304;
    picture.backend = "gl_osmesa";
    picture.backend_version = "4.5 (Core Profile)";
    picture.order = "mpvo";
    picture.order_exact = true;
    picture.order_check = {.rays = 19, .wrong_rays = 20, .wrong_pairs = 21};
    picture.error = 0.25;
    picture.plan = {{.rule = "order", .chosen = "cells by mpvo", .why = "the medium hides what is behind it"}};
    run.pictures = {picture};

    const char* const expected = R"json({
        "once": {"ms": {"read": 1.5, "tetrahedralize": 2.5, "prepare": 3.5}},
        "pictures": [{
            "ms": {"plan": 1.0, "sort": 2.0, "project": 3.0, "draw": 4.0, "read_back": 5.0, "total": 6.0, "write": 7.0},
            "counts": {"cells": 11, "culled": 12, "drawn": 13, "triangles": 14, "fragments": 22, "unordered": 15, "cycles": 17, "split_cells": 18,
                       "order_violations": 16},
            "drawn_as": "grid", "method": "preint3d:64", "target": "rgba16f", "table_bytes": 4194304,
            "backend": "gl_osmesa", "backend_version": "4.5 (Core Profile)",
            "order": "mpvo", "order_exact": true, "order_check": {"rays": 19, "wrong_rays": 20, "wrong_pairs": 21},
            "error": 0.25,
            "plan": [{"rule": "order", "chosen": "cells by mpvo", "why": "the medium hides what is behind it"}]}],
        "peak_memory_bytes": 123456789012})json";
    EXPECT_EQ(Json::parse(to_json(run)), Json::parse(expected)) << to_json(run);
}

TEST(Statistics, KeysStandInTheOrderOfTheDesign) {
    RunStatistics run;
    run.pictures.resize(1);
    const std::string text = to_json(run);
    std::size_t last = 0;
    for (const char* key : {"once",
                            "read",
                            "tetrahedralize",
                            "prepare",
                            "pictures",
                            "plan",
                            "sort",
                            "project",
                            "draw",
                            "read_back",
                            "total",
                            "write",
                            "counts",
                            "cells",
                            "culled",
                            "drawn",
                            "triangles",
                            "fragments",
                            "unordered",
                            "cycles",
                            "split_cells",
                            "order_violations",
                            "drawn_as",
                            "method",
                            "target",
                            "backend",
                            "backend_version",
                            "order",
                            "order_exact",
                            "order_check",
                            "error",
                            "peak_memory_bytes"}) {
        const std::size_t place = text.find('"' + std::string(key) + "\":");
        ASSERT_NE(place, std::string::npos) << key;
        EXPECT_GT(place, last) << key;
        last = place;
    }
}

TEST(Statistics, WhatWasNotMeasuredIsNull) {
    RunStatistics run;
    run.pictures.resize(2);
    run.pictures[1].error = 0.0;
    const Json json = Json::parse(to_json(run));
    ASSERT_EQ(json["pictures"].size(), 2U);
    EXPECT_TRUE(json["pictures"][0].at("error").is_null());
    EXPECT_EQ(json["pictures"][1]["error"], 0.0);
}

TEST(Statistics, NoPictureIsAnEmptyList) {
    const Json json = Json::parse(to_json(RunStatistics()));
    EXPECT_TRUE(json.at("pictures").is_array());
    EXPECT_TRUE(json.at("pictures").empty());
}

TEST(Statistics, StrangeTextsAndNumbersStillGiveJson) {
    RunStatistics run;
    run.pictures.resize(1);
    run.pictures[0].backend_version = "quote \" backslash \\ line\n no UTF-8 \xff";
    run.pictures[0].error = std::numeric_limits<double>::quiet_NaN();
    const Json json = Json::parse(to_json(run));
    EXPECT_EQ(json["pictures"][0]["backend_version"], "quote \" backslash \\ line\n no UTF-8 \xef\xbf\xbd");
    EXPECT_TRUE(json["pictures"][0]["error"].is_null());
}

TEST(Statistics, NumbersComeBackExactly) {
    RunStatistics run;
    run.once_ms.read = 0.1 + 0.2;
    run.once_ms.prepare = 1e-300;
    const Json json = Json::parse(to_json(run));
    EXPECT_EQ(json["once"]["ms"]["read"].get<double>(), 0.1 + 0.2);
    EXPECT_EQ(json["once"]["ms"]["prepare"].get<double>(), 1e-300);
}

TEST(Statistics, PeakMemorySeesABlockThatIsWrittenToAndNeverFalls) {
    constexpr std::size_t block = std::size_t{64} << 20;
    const std::size_t before = peak_memory_bytes();
    EXPECT_GT(before, std::size_t{1} << 20) << "a running program holds more than 1 MiB";
    {
        // Larger than all that was ever resident, so the peak must move. volatile: the writes must happen.
        const std::size_t size = before + block;
        const std::vector<char> bytes(size, 1);
        const volatile char* touched = bytes.data();
        EXPECT_EQ(touched[size - 1], 1);
        EXPECT_GE(peak_memory_bytes(), size) << "every page was written";
    }
    EXPECT_GE(peak_memory_bytes(), before + block);
}

TEST(Statistics, AStopwatchCountsUpwards) {
    const Stopwatch watch;
    const double first = watch.ms();
    EXPECT_GE(first, 0.0);
    EXPECT_GE(watch.ms(), first);
}

}  // namespace
}  // namespace cellproj
