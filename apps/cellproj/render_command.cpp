// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "annotation_options.hpp"
#include "commands.hpp"
#include "grid_options.hpp"
#include "mesh/error.hpp"
#include "progress.hpp"
#include "render/grid_trade.hpp"
#include "render/output_file.hpp"
#include "render/plan.hpp"
#include "render/renderer.hpp"
#include "scene_options.hpp"

namespace cellproj::cli {

namespace {

// Enough to meet a wrong order that shows, and done in about a second.
constexpr std::size_t rays_of_proof = 4096;

struct RenderOptions {
    SceneOptions scene;
    AnnotationOptions annotations;
    std::filesystem::path output, stats;
    std::string method = to_string(Method{}), target = to_string(Quality{}.target), order = "auto", sampling = "cells";
    bool sampling_chosen = false;
    std::string iso_method = to_string(SurfaceMethod{});
    std::optional<double> max_error;  // --max-error: the method is chosen by measuring
    bool verify_order = false, explain = false;
    std::vector<double> background{1, 1, 1};
    std::string backend = "auto";
    int threads = 0;
    double orbit_degrees = 0;
    int frames = 1, bits = 8;
};

// The camera of each picture: those that were asked for, or one of them turned.
std::vector<Camera> cameras_of_pictures(const RenderOptions& options, const Input& input, ImageSize size) {
    std::vector<Camera> cameras = choose_cameras(options.scene, input, size, options.frames > 1);
    if (options.frames == 1) return cameras;
    if (cameras.size() != 1) {
        throw Error({ErrorKind::option, "--frames", "one camera to turn",
                     std::to_string(cameras.size()) + " cameras in " + options.scene.camera.string(),
                     "leave --orbit and --frames out, or give one camera"});
    }
    std::vector<Camera> turned;
    for (int i = 0; i < options.frames; ++i) {
        turned.push_back(orbit(cameras.front(), options.orbit_degrees * i / options.frames));
    }
    return turned;
}

// For CLI11: what is wrong with the text, nothing when it is a number above 0 and at most 1.
std::string positive_error(std::string& text) {
    double value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && value > 0 && value <= 1;
    return good ? "" : text + " is no error above 0 and up to 1, such as 0.002";
}

// picture.png → picture_007.png when there are several.
std::filesystem::path numbered(const std::filesystem::path& file, std::size_t index, std::size_t count) {
    if (count == 1) return file;
    char number[32];
    std::snprintf(number, sizeof number, "_%03zu", index);
    return file.parent_path() / (file.stem().string() + number + file.extension().string());
}

void write(const Image& image, const std::filesystem::path& file, const RenderOptions& options,
           const std::map<std::string, std::string>& text) {
    if (file.extension() == ".exr") {
        write_exr(image, file, text);
    } else {
        write_png(image, file, {.background = {options.background[0], options.background[1], options.background[2]}, .bits = options.bits, .text = text});
    }
}

// No blank or doubtful picture without a word. `shown`: what decides what there is to be seen.
void warn(const Image& image, const Statistics& statistics, const std::filesystem::path& file, const char* shown) {
    const bool blank = std::all_of(image.pixels.begin(), image.pixels.end(), [](const glm::vec4& p) {
        return std::max({p.x, p.y, p.z, p.w}) < 0.5F / 255;
    });
    if (blank) {
        std::fprintf(stderr,
                     "cellproj: warning: %s is blank: %zu of %zu cells were in view and visible; check the camera and "
                     "%s\n",
                     file.c_str(), statistics.counts.drawn, statistics.counts.cells, shown);
    }
    if (!statistics.order_exact) {
        std::fprintf(stderr,
                     "cellproj: warning: %s: the order of cells (%s) is not proven to be exact for this mesh and view: colours may be "
                     "wrong where cells stand in the wrong order\n",
                     file.c_str(), statistics.order.c_str());
    }
    if (statistics.counts.unordered > 0) {
        std::fprintf(stderr,
                     "cellproj: warning: %s: %zu cells lie in visibility cycles and were ordered by depth only\n",
                     file.c_str(), statistics.counts.unordered);
    }
}

// What --verify-order found.
void print_proof(const Statistics& s) {
    if (!s.order_check) return;
    std::printf("order %s%s: %zu face relations violated; %zu of %zu rays meet cells in another order (%zu pairs)\n", s.order.c_str(),
                s.order_exact ? ", exact" : "", s.counts.order_violations.value_or(0), s.order_check->wrong_rays, s.order_check->rays,
                s.order_check->wrong_pairs);
}

void print_line(const std::filesystem::path& file, const Statistics& s) {
    const bool by_triangles = s.counts.triangles > 0;
    std::printf("%s: %zu of %zu %s, %zu %s, %.0f ms (sort %.0f, project %.0f, draw %.0f) by %s\n", file.c_str(), s.counts.drawn,
                s.counts.cells, s.drawn_as == "grid" ? "cells of the grid" : "cells", by_triangles ? s.counts.triangles : s.counts.fragments, by_triangles ? "triangles" : "fragments",
                s.ms.total, s.ms.sort, s.ms.project, s.ms.draw, s.backend.c_str());
}

// What --explain asks for; not again for pictures that were planned as the one before.
void print_plan(const Statistics& s, const Statistics* before) {
    const std::string text = in_words(s.plan);
    if (!before || text != in_words(before->plan)) std::printf("%s", text.c_str());
}

// The median over the pictures, without the first one, in which the driver compiles its shaders and tables are made.
void print_median(const std::vector<Statistics>& pictures) {
    if (pictures.size() < 3) return;
    const auto median_of = [&](double (*stage)(const Statistics&)) {
        std::vector<double> values;
        for (std::size_t i = 1; i < pictures.size(); ++i) values.push_back(stage(pictures[i]));
        return median(std::move(values));
    };
    std::printf("median of %zu views: %.0f ms (sort %.0f, project %.0f, draw %.0f)\n", pictures.size() - 1,
                median_of([](const Statistics& s) { return s.ms.total; }), median_of([](const Statistics& s) { return s.ms.sort; }),
                median_of([](const Statistics& s) { return s.ms.project; }), median_of([](const Statistics& s) { return s.ms.draw; }));
}

// What was measured, line by line, and what follows from it.
void print_choice(const QualityChoice& choice, double max_error, const ChoiceOptions& how, std::size_t views) {
    std::printf("--max-error %g: %zu methods measured on %zu pixels%s, medians of %d frames\n", max_error,
                choice.candidates.size(), choice.judged, views > 1 ? " of the first view" : "", how.rounds);
    int wide = 22;
    for (const Candidate& c : choice.candidates) wide = std::max(wide, static_cast<int>(c.name.size()));
    std::printf("  %-*s %10s %10s %9s\n", wide, "method", "max error", "RMS error", "frame ms");
    for (std::size_t i = 0; i < choice.candidates.size(); ++i) {
        const Candidate& c = choice.candidates[i];
        const bool timed = largest(c.error) <= max_error;
        char ms[32] = "-";
        if (timed) std::snprintf(ms, sizeof ms, "%.1f", c.frame_ms);
        std::printf("  %-*s %10.2e %10.2e %9s%s\n", wide, c.name.c_str(), largest(c.error), c.error.color.rms, ms,
                    i == choice.chosen ? choice.met ? "  the fastest within it" : "  taken, though above it" : "");
    }
}

// Prints a choice and warns where nothing is within the bound. The largest error of the chosen way.
double tell_choice(const QualityChoice& choice, double max_error, const ChoiceOptions& how, std::size_t views, const char* cause) {
    print_choice(choice, max_error, how, views);
    const Candidate& chosen = choice.candidates[choice.chosen];
    const double measured = largest(chosen.error);
    if (!choice.met) {
        std::fprintf(stderr, "cellproj: warning: no method was within --max-error %g on the judged pixels; %s is used, off by %.2g, which comes from %s\n",
                     max_error, chosen.name.c_str(), measured, cause);
    }
    return measured;
}

Quality choose_measured(Renderer& renderer, Backend backend, const Scene& scene, const std::vector<Camera>& cameras, ImageSize size,
                        double max_error, const Quality& base, double& measured) {
    ChoiceOptions how{.base = base};
    how.base.check_neighbours = false;  // the chosen one's order is proved once
    how.base.check_rays = 0;
    how.draws = [backend, &scene](const Quality& quality) {
        return draws(backend, quality, fields_read(scene)) && (!has_surface_scene(scene) || takes_surfaces(quality.method)) &&
               draws(quality.method, ray_cuts(scene));
    };
    const QualityChoice choice = [&] {
        const Progress progress("choosing a method");
        return choose_quality(renderer, scene, cameras.front(), size, max_error, how);
    }();
    measured = tell_choice(choice, max_error, how, cameras.size(), "the order of the cells or the target, not from the method");
    Quality quality = base;
    quality.method = choice.candidates[choice.chosen].quality.method;
    return quality;
}

// Likewise for a regular grid; `sampling`: the one that was asked for.
GridQuality choose_measured(GridRenderer& renderer, Backend backend, const GridScene& scene, const std::vector<Camera>& cameras, ImageSize size,
                            double max_error, const GridQuality& base, bool sampling_asked_for, double& measured) {
    GridChoiceOptions options{.target = base.target};
    if (sampling_asked_for) options.sampling = base.sampling;
    const QualityChoice choice = [&] {
        const Progress progress("choosing a method");
        return choose_grid_quality(renderer, backend, scene, cameras.front(), size, max_error, options);
    }();
    measured = tell_choice(choice, max_error, options.how, cameras.size(), "the sampling, the backend or the target");
    const Candidate& chosen = choice.candidates[choice.chosen];
    return {chosen.quality.method, base.target, chosen.sampling.value_or(base.sampling)};
}

// Likewise for a hierarchy of grids.
Method choose_measured(HierarchyRenderer& renderer, const HierarchyScene& scene, const std::vector<Camera>& cameras, ImageSize size, double max_error,
                       double& measured) {
    const ChoiceOptions how;
    const QualityChoice choice = [&] {
        const Progress progress("choosing a method");
        return choose_hierarchy_method(renderer, scene, cameras.front(), size, max_error, how);
    }();
    measured = tell_choice(choice, max_error, how, cameras.size(), "single precision");
    return choice.candidates[choice.chosen].quality.method;
}

// The scene, with a hierarchy of grids as tetrahedra where the renderer of hierarchies does not know what is asked for, unless --as grid was.
LoadedScene load(const RenderOptions& options, DrawnAs drawn_as, const GridQuality& quality, Backend backend) {
    LoadedScene loaded = load_scene(options.scene, drawn_as);
    if (!loaded.hierarchy) return loaded;
    try {
        require_hierarchy_drawn(options.scene, backend, quality);
        return loaded;
    } catch (const Error&) {
        const bool slabs = quality.sampling.cut != GridSampling::Cut::cells;
        if (slabs || drawn_as == DrawnAs::grid) throw;
    }
    return load_scene(options.scene, DrawnAs::tets);
}

void render_pictures(const RenderOptions& options) {
    // Everything that can be refused without reading the mesh comes first.
    const ImageSize size = require_possible(options.scene);
    Quality quality{.method = parse_method(options.method, "--method"),
                    .target = parse_target_format(options.target, "--target"),
                    .order = order_method(options.order),  // nothing: auto, pixel
                    .order_per_pixel = options.order == "pixel",
                    .surfaces = parse_surface_method(options.iso_method, "--iso-method"),
                    .check_neighbours = options.verify_order || !options.stats.empty(),
                    .check_rays = options.verify_order ? rays_of_proof : 0};
    const FieldsRead fields = options.scene.fields();
    const GridSampling sampling = parse_grid_sampling(options.sampling, "--sampling");
    const BackendWish wish = parse_backend(options.backend);
    const Gpu gpu = depends_on_gpu(wish) ? find_gpu() : Gpu{};
    const ChosenBackend grid_backend = choose_grid_backend(wish, sampling, gpu);
    const DrawnAs drawn_as =
        choose_drawn_as(options.scene, {grid_backend.backend, quality, sampling, options.max_error.has_value(), options.order != "auto"});
    const ChosenBackend mesh_backend = drawn_as == DrawnAs::grid ? grid_backend : choose_backend(wish, quality, fields, gpu);
    require_writable_image(options.output);
    const std::shared_ptr<const Font> font = require_annotated(options.annotations, options.output, size);
    if (!options.stats.empty()) require_writable(options.stats);

    const LoadedScene loaded = load(options, drawn_as, {quality.method, quality.target, sampling}, grid_backend.backend);
    const Input& input = loaded.input;
    const Scene& scene = loaded.scene;
    const std::vector<Camera> cameras = cameras_of_pictures(options, input, size);
    const Annotator annotator = make_annotator(options.annotations, options.scene, scene, size, options.background, font);
    const ImageSize view = annotator.view_size();  // what annotations leave to the volume
    std::vector<Camera> views;
    for (const Camera& camera : cameras) views.push_back(annotator.view_camera(camera));

    RunStatistics run;
    run.once_ms.read = input.read_ms;
    run.once_ms.tetrahedralize = input.tetrahedralize_ms;
    const bool as_it_is = loaded.grid || loaded.hierarchy;
    const auto renderer = as_it_is ? nullptr : make_renderer(mesh_backend.backend, {.threads = options.threads});
    const auto grid_renderer = loaded.grid ? make_grid_renderer(grid_backend.backend, {.threads = options.threads}) : nullptr;
    const auto hierarchy_renderer = loaded.hierarchy ? make_hierarchy_renderer(options.threads) : nullptr;
    GridQuality grid_quality{quality.method, quality.target, sampling};
    std::optional<double> error;  // of the first view
    if (options.max_error && renderer)
        quality = choose_measured(*renderer, mesh_backend.backend, scene, views, view, *options.max_error, quality, error.emplace());
    if (options.max_error && grid_renderer) {
        grid_quality = choose_measured(*grid_renderer, grid_backend.backend, *loaded.grid, views, view, *options.max_error, grid_quality,
                                       options.sampling_chosen, error.emplace());
    }
    if (options.max_error && hierarchy_renderer)
        quality.method = choose_measured(*hierarchy_renderer, *loaded.hierarchy, views, view, *options.max_error, error.emplace());
    const Stopwatch preparing;
    {
        const Progress progress("preparing");
        if (loaded.grid) grid_renderer->prepare(*loaded.grid, grid_quality);
        else if (loaded.hierarchy) hierarchy_renderer->prepare(*loaded.hierarchy, quality.method);
        else renderer->prepare(scene, quality);
    }
    run.once_ms.prepare = preparing.ms();
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const std::filesystem::path file = numbered(options.output, i, cameras.size());
        const Progress progress("rendering " + file.string());
        Statistics statistics;
        Image image = loaded.grid ? grid_renderer->render(*loaded.grid, views[i], view, grid_quality, &statistics)
                      : loaded.hierarchy ? hierarchy_renderer->render(*loaded.hierarchy, views[i], view, quality.method, &statistics)
                                  : renderer->render(scene, views[i], view, quality, &statistics);
        if (i == 0) statistics.error = error;
        statistics.plan.insert(statistics.plan.begin(), (as_it_is ? grid_backend : mesh_backend).decision);
        const Stopwatch writing;
        std::map<std::string, std::string> text{
            {"Software", "cellproj " CELLPROJ_VERSION},
            {"cellproj field", scene.field->name},
            {"cellproj camera", to_json(cameras[i])},
            {"cellproj method", statistics.method},
            {"cellproj target", statistics.target},
            {"cellproj drawn as", statistics.drawn_as},
            {"cellproj order", statistics.order},
            {"cellproj backend", statistics.backend + ", " + statistics.backend_version}};
        if (scene.opacity_field) text["cellproj opacity field"] = scene.opacity_field->name;
        for (const std::string& surface : options.scene.iso.surfaces)
            text["cellproj isosurfaces"] += "--iso " + surface + " ";
        if (options.scene.iso.any()) text["cellproj isosurfaces"] += "--shading " + options.scene.iso.shading;
        if (options.scene.iso.shade_volume) text["cellproj volume"] = "--shade-volume --shading " + options.scene.iso.shading;
        for (const std::string& light : options.scene.iso.lights) text["cellproj lights"] += (text["cellproj lights"].empty() ? "--light " : " --light ") + light;
        if (const std::string cuts = text_of(options.scene.cuts); !cuts.empty()) text["cellproj cuts"] = cuts;
        if (!annotator.note().empty()) text["cellproj note"] = annotator.note();
        warn(image, statistics, file, options.scene.iso.any() ? "the isovalues" : "the transfer function's range");
        write(annotator.compose(std::move(image), cameras[i]), file, options, text);
        statistics.ms.write = writing.ms();
        print_line(file, statistics);
        print_proof(statistics);
        if (options.explain) print_plan(statistics, run.pictures.empty() ? nullptr : &run.pictures.back());
        run.pictures.push_back(std::move(statistics));
    }
    print_median(run.pictures);
    run.peak_memory_bytes = peak_memory_bytes();
    if (!options.stats.empty()) write_text_file(options.stats, to_json(run) + "\n");
}

}  // namespace

void add_render_command(CLI::App& app) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Render a mesh to a picture.");
    add_scene_options(*command, options->scene);
    add_grid_options(*command, options->scene);
    add_iso_options(*command, options->scene.iso);
    command->add_option("--iso-method", options->iso_method, iso_method_help)->capture_default_str()->needs("--iso");
    add_cut_options(*command, options->scene.cuts);
    command->add_option("-o,--output", options->output, "The picture: .png or .exr; several become NAME_000.png …")
        ->required();
    add_annotation_options(*command, options->annotations);
    command->add_option("--orbit", options->orbit_degrees, "Turn the camera by DEGREES in all, over --frames pictures")
        ->check(CLI::Range(-36000.0, 36000.0));
    command->add_option("--frames", options->frames, "Number of pictures of the orbit")->check(CLI::Range(1, 100000));
    command->add_option("--background", options->background, "Colour behind the volume in a PNG: R,G,B in 0..1")
        ->expected(3)->delimiter(',')->check(CLI::Range(0.0, 1.0))->capture_default_str();
    command->add_option("--bits", options->bits, "Bits per channel of a PNG: 8 or 16")
        ->check(CLI::IsMember({8, 16}))->capture_default_str();
    command->add_option("--sampling", options->sampling,
                        "What cuts rays through a regular grid: cells, or slabs between slices by OpenGL: object:N or view:N, "
                        "behind that :pre or :post shaded, :xM slabs a polygon (render/README.md)")
        ->capture_default_str()->each([options](const std::string&) { options->sampling_chosen = true; });
    CLI::Option* method = command->add_option("--method", options->method, "How a ray's piece in a cell becomes light: NAME[:CHOICE…] (classify/README.md)")
        ->capture_default_str();
    command->add_option("--max-error", options->max_error,
                        "Measure some methods on the first view and take the fastest whose largest error of a channel (0..1) is at most this")
        ->excludes(method)->check(CLI::Validator(positive_error, "ERROR"));
    command->add_option("--target", options->target, "What cells are blended in: rgba8, rgba16, rgba16f or rgba32f")
        ->capture_default_str();
    command->add_option("--backend", options->backend,
                        "What draws: cpu (native), egl (OpenGL, on a GPU if there is one), osmesa (OpenGL on the CPU), gl: egl on a GPU, else osmesa; "
                        "auto: a GPU; without one cpu, and osmesa for methods and targets that only OpenGL has")
        ->check(CLI::IsMember({"auto", "cpu", "gl", "egl", "osmesa"}))->capture_default_str();
    command->add_option("--threads", options->threads, "Threads of the cpu backend; 0: all that the process may use")
        ->check(CLI::Range(0, 1024))->capture_default_str();
    command->add_option("--order", options->order,
                        "How cells are sorted: auto (exact for this mesh), centroid, power, mpvo, bsp or sxmpvo (sort/README.md), "
                        "or pixel: each pixel by itself, exact for any mesh (cpu backend)")
        ->check(CLI::IsMember({"auto", "centroid", "power", "mpvo", "bsp", "sxmpvo", "pixel"}))->capture_default_str();
    command->add_flag("--verify-order", options->verify_order,
                      "Prove the order of every picture: relations of neighbours, and the sequence of cells along 4096 pixels' rays");
    command->add_flag("--explain", options->explain, "Say what was chosen for the picture and why: backend, cells, order, method and more");
    command->add_option("--stats", options->stats, "Write times and counts of every picture (JSON); /dev/stdout prints them");
    command->callback([options] {
        require_something_in_volume(options->scene.iso, !options->scene.cuts.slices.empty());
        render_pictures(*options);
    });
}

}  // namespace cellproj::cli
