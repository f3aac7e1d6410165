// SPDX-License-Identifier: BSD-3-Clause
//
// Frames of several contenders in turn, what they cost, and what the judge says of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "classify/method.hpp"
#include "project/camera.hpp"

namespace cellproj::bench {

struct RunOptions {
    std::vector<std::string> scenes, transfers, contenders;
    std::vector<Camera::Projection> projections;
    std::vector<int> sizes;    // pixels along an edge
    std::vector<int> threads;  // 0: all CPUs
    Method method;             // of ours
    int frames = 5;            // behind the first, a new view each; ≥ 1
    int judged = 2000;         // pixels of the first view; 0: none
    std::filesystem::path pictures;  // a folder for the first views as PNG; empty: none
};

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// One contender in one situation. Times in milliseconds, medians over the frames behind the first; `unknown` where the contender
// does not tell.
struct Row {
    std::string scene, transfer, projection;
    std::size_t cells = 0;
    int size = 0;
    std::string contender;
    int threads = 0;
    double set_up_ms = unknown;  // what can be done before a view is known
    double first_ms = unknown;   // from nothing to the first picture, set-up included
    double frame_ms = unknown;   // wall clock, camera to pixels
    double user_ms = unknown;    // CPU time of all threads for a frame
    double sort_ms = unknown, project_ms = unknown, draw_ms = unknown;  // stages, wall clock; they may overlap
    double fragments = unknown;  // of a frame
    double peak_bytes = unknown; // most resident memory of set-up and first frame, beyond mesh and program
    double rms = unknown, maximum = unknown;  // error of the first view over R, G and B, against the judge
    std::string failure;         // why there are no numbers; empty: there are
};

// Draws everything. Each contender is a process of its own, alone while it works; in each round every contender draws the same new
// view once. Tells on the standard error what it is at. The caller has no other threads. Throws Error for a scene that cannot be
// made; what fails in a contender is told in its row.
std::vector<Row> run(const RunOptions& options);

}  // namespace cellproj::bench
