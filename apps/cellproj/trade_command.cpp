// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "grid_options.hpp"
#include "mesh/error.hpp"
#include "progress.hpp"
#include "render/output_file.hpp"
#include "render/plan.hpp"
#include "render/statistics.hpp"
#include "render/trade.hpp"
#include "scene_options.hpp"
#include "trade_report.hpp"
#include "trade_ways.hpp"

namespace cellproj::cli {

namespace {

struct TradeCommandOptions {
    SceneOptions scene;
    TradeChoices choices;
    std::filesystem::path page, csv, json;
    std::optional<std::size_t> sample;
    int rounds = 5;
    std::string backend = "auto";
};

std::string in_words(BackendWish wish, const Gpu& gpu) {
    const char* egl = gpu.found ? "OpenGL on a GPU" : "OpenGL by EGL";
    switch (wish) {
        case BackendWish::cpu: return "the native backend";
        case BackendWish::egl: return egl;
        case BackendWish::osmesa: return "OpenGL on OSMesa";
        case BackendWish::gl: return gpu.found ? egl : "OpenGL on OSMesa";
        case BackendWish::automatic: break;
    }
    return gpu.found ? egl : "the native backend, OpenGL on OSMesa for what it does not draw";
}

void check_files(const TradeCommandOptions& options) {
    std::vector<std::filesystem::path> files{options.page, options.csv, options.json};
    std::erase_if(files, [](const auto& file) { return file.empty(); });
    for (std::size_t i = 0; i < files.size(); ++i) {
        require_writable(files[i]);
        if (std::find(files.begin(), files.begin() + static_cast<std::ptrdiff_t>(i), files[i]) != files.begin() + static_cast<std::ptrdiff_t>(i)) {
            throw Error({ErrorKind::option, "-o, --csv, --json", "a file for each", files[i].string() + " twice", "give another name"});
        }
    }
}

struct Truths {
    std::vector<PixelTruth> pixels;
    bool whole_picture;
};

// Of --sample pixels, or of all that see a cell where that is affordable: where it takes less than half a minute on this machine, as
// the usual sample tells.
Truths find_truths(const TradeCommandOptions& options, const TradeJudge& judge, ImageSize size) {
    constexpr std::size_t usual_sample = 20000;
    constexpr double affordable_ms = 30000;
    const Progress progress("finding the truth");
    const std::vector<PixelId> seen = judge.sample(std::numeric_limits<std::size_t>::max());
    const bool thinned = size.width * static_cast<double>(size.height) > 1e6;  // by sample_pixels
    const Stopwatch judging;
    auto truths = judge.truths(judge.sample(options.sample.value_or(usual_sample)));
    const double share = static_cast<double>(truths.size()) / static_cast<double>(std::max<std::size_t>(seen.size(), 1));
    if (!options.sample && truths.size() < seen.size() && !thinned && judging.ms() < affordable_ms * share)
        truths = judge.truths(seen);
    const bool whole_picture = !thinned && truths.size() == seen.size();
    return {std::move(truths), whole_picture};
}

// Whether a regular grid is drawn as it is; whether it can be, turns out per way.
DrawnAs drawn_as(const TradeCommandOptions& options) {
    return choose_drawn_as(options.scene, {Backend::cpu, {}, {}, false, false});
}

// A hierarchy of grids with isosurfaces or lit as tetrahedra: its renderer knows neither.
LoadedScene load(const TradeCommandOptions& options, DrawnAs drawn) {
    LoadedScene loaded = load_scene(options.scene, drawn);
    if (!loaded.hierarchy || !options.scene.iso.any_shaded()) return loaded;
    if (drawn == DrawnAs::grid) require_hierarchy_drawn(options.scene, Backend::cpu, {});
    return load_scene(options.scene, DrawnAs::tets);
}

void run_trade(const TradeCommandOptions& options) {
    const ImageSize size = require_possible(options.scene);
    const std::vector<Quality> qualities = choose_qualities(options.scene, options.choices);
    const bool slabs = !choose_samplings(options.choices).empty();
    const DrawnAs drawn = drawn_as(options);
    if (drawn == DrawnAs::tets) require_all_drawn(options.scene, options.choices, qualities);
    check_files(options);
    const LoadedScene loaded = load(options, drawn);
    const bool as_it_is = loaded.grid || loaded.hierarchy;
    if (!loaded.grid && slabs) {
        throw Error({ErrorKind::option, "--sampling", "a regular grid, drawn as it is", loaded.input.format, "leave it out"});
    }
    if (!as_it_is) require_all_drawn(options.scene, options.choices, qualities);
    const Scene& scene = loaded.scene;
    const Input& input = loaded.input;
    const std::vector<Camera> cameras = choose_cameras(options.scene, input, size, false);
    if (cameras.size() != 1) {
        throw Error({ErrorKind::option, "--camera", "one camera", std::to_string(cameras.size()), "give one of them"});
    }
    const Camera& camera = cameras.front();
    const TradeSubject subject = loaded.grid ? grid_subject(options.scene, loaded, options.choices, qualities, camera, size)
                                 : loaded.hierarchy ? hierarchy_subject(options.scene, loaded, options.choices, qualities, camera, size)
                                             : mesh_subject(loaded, options.choices, qualities, camera, size);
    const Truths judged = find_truths(options, subject.judge, size);
    std::vector<TradeRow> rows = [&] {
        Progress progress("rendering in " + std::to_string(subject.ways.size()) + " ways");
        const auto tell = [&](std::size_t done, std::size_t of) {
            progress.set(static_cast<double>(done) / static_cast<double>(of));
        };
        return measure_trade(subject.ways, judged.pixels,
                             {.rounds = options.rounds, .keep_images = !options.page.empty(), .progress = tell});
    }();
    std::sort(rows.begin(), rows.end(), [](const TradeRow& a, const TradeRow& b) { return a.frame_ms < b.frame_ms; });

    const std::string opacity = scene.opacity_field ? ", opacity by " + scene.opacity_field->name : "";
    const TradeReport report{.scene = input.name + ", field " + scene.field->name + opacity + ", " + subject.cells + ", " + options.scene.size,
                             .judged = judged.pixels.size(),
                             .whole_picture = judged.whole_picture,
                             .rounds = options.rounds,
                             .backend = in_words(options.choices.wish, options.choices.gpu),
                             .rows = rows,
                             .truth = to_image(judged.pixels, size),
                             .truths = judged.pixels};
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
    add_grid_options(*command, options->scene);
    command->add_option("--method", options->choices.methods, "Measure this method (again for more); default: all, several sizes")
        ->allow_extra_args(false);
    command->add_option("--target", options->choices.targets, "Blend the cells in this format (again for more): rgba8, rgba16, rgba16f or rgba32f")
        ->allow_extra_args(false);
    command->add_option("--sampling", options->choices.samplings,
                        "What cuts rays through a regular grid (again for more): cells, object:N, view:N (render/README.md); default: several")
        ->allow_extra_args(false);
    add_iso_options(*command, options->scene.iso);
    command->add_option("--iso-method", options->choices.iso_methods, std::string(iso_method_help) + " (again for more)")
        ->allow_extra_args(false)->needs("--iso");
    command->add_option("--sample", options->sample,
                        "Pixels judged by rays in float64; default: all that see the mesh when that takes less than 30 s, else 20000")
        ->check(CLI::Range(1, 100000000));
    command->add_option("--rounds", options->rounds, "Frames timed per method; the median counts")
        ->check(CLI::Range(1, 1000))->capture_default_str();
    command->add_option("--backend", options->backend, "What draws: cpu (native), egl (OpenGL, on a GPU if there is one), osmesa (OpenGL on the CPU), gl: egl on a GPU, else osmesa; "
                        "auto: a GPU; without one cpu, and osmesa for what only OpenGL draws")
        ->check(CLI::IsMember({"auto", "cpu", "gl", "egl", "osmesa"}))->capture_default_str();
    command->add_option("-o,--output", options->page, "Write a page with table, plot, pictures and error maps (HTML)");
    command->add_option("--csv", options->csv, "Write the table as CSV");
    command->add_option("--json", options->json, "Write the table as JSON");
    command->callback([options] {
        require_something_in_volume(options->scene.iso, false);
        options->choices.wish = parse_backend(options->backend);
        if (depends_on_gpu(options->choices.wish)) options->choices.gpu = find_gpu();
        run_trade(*options);
    });
}

}  // namespace cellproj::cli
