// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "mesh/error.hpp"
#include "progress.hpp"
#include "render/output_file.hpp"
#include "render/plan.hpp"
#include "render/statistics.hpp"
#include "render/trade.hpp"
#include "scene_options.hpp"
#include "trade_report.hpp"

namespace cellproj::cli {

namespace {

struct TradeCommandOptions {
    SceneOptions scene;
    std::vector<std::string> methods, targets, iso_methods;  // all empty: trade_qualities, surface_qualities
    std::filesystem::path page, csv, json;
    std::optional<std::size_t> sample;
    int rounds = 5;
    std::string backend = "auto";
    // What follows of it on this machine.
    BackendWish wish = BackendWish::automatic;
    Gpu gpu;
};

// The backend that `render` would take, for each quality. Renderers are made when they are wanted first.
class ChosenRenderer : public Renderer {
public:
    explicit ChosenRenderer(const TradeCommandOptions& options) : wish_(options.wish), gpu_(options.gpu) {}

    void prepare(const Scene& scene, const Quality& quality) override { of(scene, quality).prepare(scene, quality); }
    Image render(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality, Statistics* statistics) override {
        return of(scene, quality).render(scene, camera, size, quality, statistics);
    }

private:
    Renderer& of(const Scene& scene, const Quality& quality) {
        std::unique_ptr<Renderer>& renderer = renderers_[wished_backend(wish_, quality, fields_read(scene), gpu_)];
        if (!renderer) renderer = make_renderer(wished_backend(wish_, quality, fields_read(scene), gpu_));
        return *renderer;
    }

    BackendWish wish_;
    Gpu gpu_;
    std::map<Backend, std::unique_ptr<Renderer>> renderers_;
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

// The backend that has to draw a quality.
Backend backend_for(const TradeCommandOptions& options, const Quality& quality) {
    return wished_backend(options.wish, quality, options.scene.fields(), options.gpu);
}

// Those that can draw the scene.
std::vector<Quality> possible_qualities(const TradeCommandOptions& options) {
    std::vector<Quality> qualities = options.scene.iso.any_shaded() ? surface_qualities() : trade_qualities();
    std::erase_if(qualities, [&](const Quality& quality) {
        return !draws(backend_for(options, quality), quality, options.scene.fields()) ||
               (!options.scene.iso.any() && quality.surfaces.kind != SurfaceMethodKind::exact);
    });
    return qualities;
}

// Each of the qualities, changed in each of the ways that were asked for.
template <class Change>
std::vector<Quality> varied(const std::vector<Quality>& qualities, const std::vector<std::string>& ways, Change change) {
    if (ways.empty()) return qualities;
    std::vector<Quality> all;
    for (const std::string& way : ways)
        for (Quality quality : qualities) {
            change(quality, way);
            all.push_back(quality);
        }
    return all;
}

// Every method in every target and with every way to isosurfaces; the usual one of what is not given.
std::vector<Quality> choose_qualities(const TradeCommandOptions& options) {
    if (options.methods.empty() && options.targets.empty() && options.iso_methods.empty()) return possible_qualities(options);
    std::vector<Quality> usual;
    for (const std::string& text : options.methods) usual.push_back({.method = parse_method(text, "--method")});
    if (options.methods.empty()) {
        usual = possible_qualities(options);
        std::erase_if(usual, [](const Quality& quality) {
            return quality.target != Quality{}.target || (quality.surfaces.kind != SurfaceMethodKind::exact);
        });
    }
    usual = varied(usual, options.iso_methods, [](Quality& quality, const std::string& text) {
        quality.surfaces = parse_surface_method(text, "--iso-method");
    });
    return varied(usual, options.targets, [](Quality& quality, const std::string& text) {
        quality.target = parse_target_format(text, "--target");
    });
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

// Of --sample pixels, or of all that see the mesh where that is affordable: where it takes less than half a minute on this machine, as
// the usual sample tells.
Truths find_truths(const TradeCommandOptions& options, const Scene& scene, const Camera& camera, ImageSize size) {
    constexpr std::size_t usual_sample = 20000;
    constexpr double affordable_ms = 30000;
    const Progress progress("finding the truth");
    const Reference reference(scene);
    const std::vector<PixelId> seen = reference.sample(camera, size, std::numeric_limits<std::size_t>::max());
    const bool thinned = size.width * static_cast<double>(size.height) > 1e6;  // by Reference::sample
    const Stopwatch judging;
    auto truths = reference.pixels(camera, size, reference.sample(camera, size, options.sample.value_or(usual_sample)), rasterizer_slack);
    const double share = static_cast<double>(truths.size()) / static_cast<double>(std::max<std::size_t>(seen.size(), 1));
    if (!options.sample && truths.size() < seen.size() && !thinned && judging.ms() < affordable_ms * share)
        truths = reference.pixels(camera, size, seen, rasterizer_slack);
    const bool whole_picture = !thinned && truths.size() == seen.size();
    return {std::move(truths), whole_picture};
}

void run_trade(const TradeCommandOptions& options) {
    const ImageSize size = require_possible(options.scene);
    const std::vector<Quality> qualities = choose_qualities(options);
    if (qualities.empty()) require_drawn(backend_for(options, {}), {}, options.scene.fields());  // says why there is none
    for (const Quality& quality : qualities) require_drawn(backend_for(options, quality), quality, options.scene.fields());
    check_files(options);
    const LoadedScene loaded = load_scene(options.scene);
    const Scene& scene = loaded.scene;
    const Input& input = loaded.input;
    const std::vector<Camera> cameras = choose_cameras(options.scene, input, size, false);
    if (cameras.size() != 1) {
        throw Error({ErrorKind::option, "--camera", "one camera", std::to_string(cameras.size()), "give one of them"});
    }
    const Camera& camera = cameras.front();
    const Truths judged = find_truths(options, scene, camera, size);
    const auto renderer = std::make_unique<ChosenRenderer>(options);
    std::vector<TradeRow> rows = [&] {
        Progress progress("rendering in " + std::to_string(qualities.size()) + " ways");
        const auto tell = [&](std::size_t done, std::size_t of) {
            progress.set(static_cast<double>(done) / static_cast<double>(of));
        };
        return measure_trade(*renderer, scene, camera, size, qualities, judged.pixels,
                             {.rounds = options.rounds, .keep_images = !options.page.empty(), .progress = tell});
    }();
    std::sort(rows.begin(), rows.end(), [](const TradeRow& a, const TradeRow& b) { return a.frame_ms < b.frame_ms; });

    const std::string opacity = scene.opacity_field ? ", opacity by " + scene.opacity_field->name : "";
    const TradeReport report{.scene = input.name + ", field " + scene.field->name + opacity + ", " + std::to_string(scene.mesh->tets.size()) +
                                      " tetrahedra, " + options.scene.size,
                             .judged = judged.pixels.size(),
                             .whole_picture = judged.whole_picture,
                             .rounds = options.rounds,
                             .backend = in_words(options.wish, options.gpu),
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
    command->add_option("--method", options->methods, "Measure this method (again for more); default: all, several sizes")
        ->allow_extra_args(false);
    command->add_option("--target", options->targets, "Blend the cells in this format (again for more): rgba8, rgba16, rgba16f or rgba32f")
        ->allow_extra_args(false);
    add_iso_options(*command, options->scene.iso);
    command->add_option("--iso-method", options->iso_methods, std::string(iso_method_help) + " (again for more)")
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
        options->wish = parse_backend(options->backend);
        if (depends_on_gpu(options->wish)) options->gpu = find_gpu();
        run_trade(*options);
    });
}

}  // namespace cellproj::cli
