// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "mesh/error.hpp"
#include "progress.hpp"
#include "render/output_file.hpp"
#include "render/trade.hpp"
#include "scene_options.hpp"
#include "trade_report.hpp"

namespace cellproj::cli {

namespace {

struct TradeCommandOptions {
    SceneOptions scene;
    std::vector<std::string> methods;  // empty: all
    std::filesystem::path page, csv, json;
    std::size_t sample = 20000;
    int rounds = 5;
};

std::vector<Quality> choose_qualities(const TradeCommandOptions& options) {
    if (options.methods.empty()) return trade_qualities();
    std::vector<Quality> qualities;
    for (const std::string& method : options.methods) qualities.push_back({.method = parse_method(method, "--method")});
    return qualities;
}

void run_trade(const TradeCommandOptions& options) {
    const ImageSize size = require_possible(options.scene);
    const std::vector<Quality> qualities = choose_qualities(options);
    for (const auto& file : {options.page, options.csv, options.json}) {
        if (!file.empty()) require_writable(file);
    }
    const LoadedScene loaded = load_scene(options.scene);
    const Scene& scene = loaded.scene;
    const Input& input = loaded.input;
    const std::vector<Camera> cameras = choose_cameras(options.scene, input, size, false);
    if (cameras.size() != 1) {
        throw Error({ErrorKind::option, "--camera", "one camera", std::to_string(cameras.size()), "give one of them"});
    }
    const Camera& camera = cameras.front();
    const auto truths = [&] {
        const Progress progress("finding the truth");
        const Reference reference(scene);
        return reference.pixels(camera, size, reference.sample(camera, size, options.sample), 1.0 / 512);
    }();
    const auto renderer = make_renderer(Backend::gl_osmesa);
    std::vector<TradeRow> rows = [&] {
        Progress progress("rendering with " + std::to_string(qualities.size()) + " methods");
        const auto tell = [&](std::size_t done, std::size_t of) {
            progress.set(static_cast<double>(done) / static_cast<double>(of));
        };
        return measure_trade(*renderer, scene, camera, size, qualities, truths, {.rounds = options.rounds, .progress = tell});
    }();
    std::sort(rows.begin(), rows.end(), [](const TradeRow& a, const TradeRow& b) { return a.frame_ms < b.frame_ms; });

    const TradeReport report{.scene = input.name + ", field " + scene.field->name + ", " + std::to_string(scene.mesh->tets.size()) +
                                      " tetrahedra, " + options.scene.size,
                             .judged = truths.size(),
                             .rounds = options.rounds,
                             .backend = "OpenGL on OSMesa",
                             .rows = rows,
                             .truth = to_image(truths, size),
                             .truths = truths};
    std::fputs(to_table(report).c_str(), stdout);
    if (!options.csv.empty()) write_text_file(options.csv, to_csv(report));
    if (!options.json.empty()) write_text_file(options.json, to_json(report) + "\n");
    if (!options.page.empty()) write_text_file(options.page, to_html(report));
}

}  // namespace

void add_trade_command(CLI::App& app) {
    auto options = std::make_shared<TradeCommandOptions>();
    CLI::App* command = app.add_subcommand("trade", "Measure time against error for every method of integration on a scene.");
    add_scene_options(*command, options->scene);
    command->add_option("--method", options->methods, "Measure this method (again for more); default: all, several sizes")
        ->allow_extra_args(false);
    command->add_option("--sample", options->sample, "Pixels judged by rays in float64; all that see the mesh when it has no more")
        ->check(CLI::Range(1, 100000000))->capture_default_str();
    command->add_option("--rounds", options->rounds, "Frames timed per method; the median counts")
        ->check(CLI::Range(1, 1000))->capture_default_str();
    command->add_option("-o,--output", options->page, "Write a page with table, plot, pictures and error maps (HTML)");
    command->add_option("--csv", options->csv, "Write the table as CSV");
    command->add_option("--json", options->json, "Write the table as JSON");
    command->callback([options] { run_trade(*options); });
}

}  // namespace cellproj::cli
