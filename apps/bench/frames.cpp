// SPDX-License-Identifier: BSD-3-Clause
//
// cellproj_frames: whole frames of every backend, timed and judged, and VTK's beside them: the times of frames in the README.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "apps/bench/frames_contender.hpp"
#include "apps/bench/frames_report.hpp"
#include "apps/bench/frames_run.hpp"

namespace {

using cellproj::Camera;
using namespace cellproj::bench;

constexpr const char* description =
    "Draws scenes by cellproj's backends and, where it was built with them, by VTK's mappers, in turn, a new view\n"
    "each frame, each in a process of its own, and prints what a frame costs and how wrong it is.\n"
    "\n"
    "  cellproj_frames                                   0.2M tetrahedra: a minute, five with VTK\n"
    "  cellproj_frames --all --csv all.csv               everything the README tells: an hour or two with VTK\n"
    "  cellproj_frames --contenders cpu --threads 1,2    how it scales\n"
    "\n"
    "Columns: set_up_ms what is done before a view is known; first_ms from nothing to the first picture, set-up\n"
    "included; frame_ms a later frame (median, wall clock); user_ms CPU time of all threads for it (median);\n"
    "peak_mb, bytes_per_tet the peak of memory beside the mesh; rms, max the error of R, G and B in the first view.";

void write_file(const std::string& file, const std::string& text) {
    if (file.empty()) return;
    std::ofstream stream(file, std::ios::binary);
    if (!(stream << text << std::flush)) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);  // a contender that dies is told in its row
    RunOptions options;
    options.scenes = {"grid:33", "delaunay:31000"};
    options.transfers = {"ramp", "peaks"};
    options.sizes = {512};
    options.threads = {0};
    std::vector<std::string> projections{"perspective"};
    std::string method = "integral", csv, markdown;
    bool all = false;
    // ZSweep takes 7 to 16 s a frame where the others take one: by name only.
    std::vector<std::string> names = contender_names();
    for (const std::string& name : names)
        if (name != "cpu-pixel" && name != "vtk-zsweep") options.contenders.push_back(name);

    CLI::App app{description, "cellproj_frames"};
    auto* scenes = app.add_option("--scenes", options.scenes, "grid:N (N points along an edge), delaunay:N (N points), bluntfin");
    app.add_option("--transfers", options.transfers, "ramp, peaks")->check(CLI::IsMember({"ramp", "peaks"}));
    auto* projection = app.add_option("--projections", projections, "perspective, parallel")->check(CLI::IsMember({"perspective", "parallel"}));
    auto* sizes = app.add_option("--sizes", options.sizes, "pixels along an edge of the picture")->check(CLI::Range(1, 16384));
    app.add_option("--contenders", options.contenders)->check(CLI::IsMember(names));
    app.add_option("--threads", options.threads, "CPUs given to each contender; 0: all")->check(CLI::Range(0, 1024));
    app.add_option("--method", method, "how segments become light in cellproj's own backends")->capture_default_str();
    app.add_option("--frames", options.frames, "behind the first")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--judge", options.judged, "pixels that are compared with the reference; 0: none")->check(CLI::Range(0, 1 << 24))->capture_default_str();
    app.add_flag("--all", all, "grid:33, grid:65, grid:101, delaunay:31000, bluntfin; both projections; 512 and 1024 pixels, unless told otherwise");
    app.add_option("--csv", csv, "a file for the numbers");
    app.add_option("--markdown", markdown, "a file for the table");
    app.add_option("--pictures", options.pictures, "an existing folder for the first views, over black")->check(CLI::ExistingDirectory);
    for (CLI::Option* option : app.get_options())
        if (option->get_items_expected_max() > 1) option->delimiter(',');
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }

    try {
        if (all && scenes->empty()) options.scenes = {"grid:33", "delaunay:31000", "bluntfin", "grid:65", "grid:101"};
        if (all && projection->empty()) projections = {"perspective", "parallel"};
        if (all && sizes->empty()) options.sizes = {512, 1024};
        for (const std::string& name : projections)
            options.projections.push_back(name == "parallel" ? Camera::Projection::parallel : Camera::Projection::perspective);
        options.method = cellproj::parse_method(method, "--method");
        const std::vector<Row> rows = run(options);
        std::fputs(to_table(rows).c_str(), stdout);
        write_file(csv, to_csv(rows));
        write_file(markdown, to_markdown(rows));
        return std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.failure.empty(); }) ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cellproj_frames: %s\n", error.what());
        return 1;
    }
}
