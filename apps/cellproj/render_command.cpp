// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "classify/presets.hpp"
#include "commands.hpp"
#include "input.hpp"
#include "mesh/error.hpp"
#include "mesh/scalar_field.hpp"
#include "progress.hpp"
#include "render/output_file.hpp"
#include "render/renderer.hpp"
#include "surface_input.hpp"

namespace cellproj::cli {

namespace {

struct RenderOptions {
    InputOptions input;
    bool tetrahedralize = false;
    SurfaceOptions surface;
    std::filesystem::path output, camera, transfer, stats;
    std::string field, projection = "perspective", size = "512x512", cell_values = "constant",
                method = to_string(Method{}), target = to_string(Quality{}.target);
    std::vector<double> from{-1, -2, 1}, up{0, 0, 1}, background{1, 1, 1};
    std::optional<double> nan;
    double orbit_degrees = 0;
    int frames = 1, bits = 8;
    std::string colors = preset_names().front(), axis = "linear";
    std::vector<double> range;  // empty, or low and high
    double opacity_scale = 1;
    bool colors_chosen = false;  // by any of --colors, --range, --axis
};

glm::dvec3 vector3(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

ImageSize parse_size(const std::string& text) {
    ImageSize size;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2) {
        throw Error({ErrorKind::option, "--size", "WIDTHxHEIGHT, such as 800x600", text, ""});
    }
    validate(size, "--size");
    return size;
}

std::vector<Camera> choose_cameras(const RenderOptions& options, const Input& input, ImageSize size) {
    std::vector<Camera> cameras;
    if (!options.camera.empty()) {
        cameras = read_cameras(options.camera);
    } else if (input.camera) {
        cameras = {*input.camera};
    } else {
        const auto frame = options.frames > 1 ? frame_sphere : frame_bounds;
        cameras = {frame(bounds(input.mesh->points),
                         options.projection == "parallel" ? Camera::Projection::parallel
                                                          : Camera::Projection::perspective,
                         vector3(options.from), vector3(options.up), static_cast<double>(size.width) / size.height)};
        validate(cameras.front(), "--from, --up");
    }
    if (options.frames == 1) return cameras;
    if (cameras.size() != 1) {
        throw Error({ErrorKind::option, "--frames", "one camera to turn",
                     std::to_string(cameras.size()) + " cameras in " + options.camera.string(),
                     "leave --orbit and --frames out, or give one camera"});
    }
    std::vector<Camera> turned;
    for (int i = 0; i < options.frames; ++i) {
        turned.push_back(orbit(cameras.front(), options.orbit_degrees * i / options.frames));
    }
    return turned;
}

// The mean length of the rays through a mesh over all that meet its box: 4 · volume / surface of the box (Cauchy). Thin and sparse
// meshes get more extinction by it than compact ones of the same diagonal.
double mean_path(const TetMesh& mesh) {
    double volume = 0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) volume += std::abs(signed_volume(mesh, cell));
    const Bounds box = bounds(mesh.points);
    const glm::dvec3 edge = box.high - box.low;
    const double surface = 2 * (edge.x * edge.y + edge.y * edge.z + edge.z * edge.x);
    return volume > 0 && surface > 0 ? 4 * volume / surface : box.diagonal();
}

std::string in_words(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", number);
    return text;
}

struct ScalarRange {
    double low, high;
};

// --range, or what most of the field lies in: the 1 % at each end are outliers more often than flow.
ScalarRange choose_range(const RenderOptions& options, const ScalarField& field) {
    if (!options.range.empty()) return {options.range[0], options.range[1]};
    const ScalarRange most{quantile(field.values, 0.01), quantile(field.values, 0.99)};
    if (most.low < most.high) return most;
    const auto whole = range(field.values);
    return {whole.low, whole.high};
}

TransferFunction preset_transfer(const RenderOptions& options, const Input& input, const ScalarField& field) {
    const auto [low, high] = choose_range(options, field);
    const bool log = options.axis == "log";
    if (log && !(low > 0)) {
        throw Error({ErrorKind::option, "--axis log", "a range above 0",
                     in_words(low) + " .. " + in_words(high) + " of field \"" + field.name + '"',
                     "give --range LOW,HIGH with LOW > 0"});
    }
    // A cube's diagonal is 2.6 times its mean path.
    return default_transfer_function(low, high, 2.6 * mean_path(*input.mesh), options.colors,
                                     log ? ScalarAxis::log : ScalarAxis::linear);
}

std::shared_ptr<const TransferFunction> choose_transfer(const RenderOptions& options, const Input& input,
                                                        const ScalarField& field) {
    const bool from_scene = input.transfer && options.field.empty() && !options.colors_chosen;
    const TransferFunction transfer = !options.transfer.empty() ? read_transfer_function(options.transfer)
                                      : from_scene              ? *input.transfer
                                                                : preset_transfer(options, input, field);
    return std::make_shared<TransferFunction>(with_scaled_extinction(transfer, options.opacity_scale));
}

// What can be refused without a mesh.
void check_colors(const RenderOptions& options) {
    preset_colors(options.colors, 0, 1, ScalarAxis::linear, "--colors");
    if (options.range.empty()) return;
    const double low = options.range[0], high = options.range[1];
    if (!(low <= high && std::max(-low, high) <= 1e150)) {
        throw Error({ErrorKind::option, "--range", "LOW,HIGH with LOW ≤ HIGH, of magnitude up to 1e150",
                     in_words(low) + "," + in_words(high), "correct it"});
    }
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
        write_png(image, file, {.background = vector3(options.background), .bits = options.bits, .text = text});
    }
}

void warn_of_values(const ScalarField& field) {
    const std::size_t bad = range(field.values).not_finite;
    if (bad == 0) return;
    std::fprintf(stderr, "cellproj: warning: field \"%s\": %zu of %zu values are not finite; cells that touch them are left out\n",
                 field.name.c_str(), bad, field.values.size());
}

// No blank or doubtful picture without a word.
void warn(const Image& image, const Statistics& statistics, const std::filesystem::path& file) {
    const bool blank = std::all_of(image.pixels.begin(), image.pixels.end(), [](const glm::vec4& p) {
        return std::max({p.x, p.y, p.z, p.w}) < 0.5F / 255;
    });
    if (blank) {
        std::fprintf(stderr,
                     "cellproj: warning: %s is blank: %zu of %zu cells were in view and visible; check the camera and "
                     "the transfer function's range\n",
                     file.c_str(), statistics.counts.drawn, statistics.counts.cells);
    }
    if (statistics.counts.unordered > 0) {
        std::fprintf(stderr,
                     "cellproj: warning: %s: %zu cells lie in visibility cycles and were ordered by depth only\n",
                     file.c_str(), statistics.counts.unordered);
    }
}

void print_line(const std::filesystem::path& file, const Statistics& s) {
    std::printf("%s: %zu of %zu cells, %zu triangles, %.0f ms (sort %.0f, project %.0f, draw %.0f)\n", file.c_str(),
                s.counts.drawn, s.counts.cells, s.counts.triangles, s.ms.total, s.ms.sort, s.ms.project, s.ms.draw);
}

// The median over the pictures, without the first one, in which the driver compiles its shaders and tables are made.
void print_median(const std::vector<Statistics>& pictures) {
    if (pictures.size() < 3) return;
    const auto median = [&](double (*stage)(const Statistics&)) {
        std::vector<double> values;
        for (std::size_t i = 1; i < pictures.size(); ++i) values.push_back(stage(pictures[i]));
        std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
        return values[values.size() / 2];
    };
    std::printf("median of %zu views: %.0f ms (sort %.0f, project %.0f, draw %.0f)\n", pictures.size() - 1,
                median([](const Statistics& s) { return s.ms.total; }), median([](const Statistics& s) { return s.ms.sort; }),
                median([](const Statistics& s) { return s.ms.project; }), median([](const Statistics& s) { return s.ms.draw; }));
}

// Cell fields are exact as constants; averaged to the points they look smooth.
ScalarField choose_field(const RenderOptions& options, const Input& input) {
    ScalarField field = select_scalar(*input.mesh, options.field, input.name);
    if (options.nan) field = with_finite_values(std::move(field), *options.nan);
    const bool averaged = field.location == FieldLocation::cells && options.cell_values == "averaged";
    return averaged ? averaged_to_points(*input.mesh, field) : field;
}

void render_pictures(const RenderOptions& options) {
    // Everything that can be refused without reading the mesh comes first.
    const ImageSize size = parse_size(options.size);
    const Quality quality{.method = parse_method(options.method, "--method"),
                          .target = parse_target_format(options.target, "--target")};
    require_writable_image(options.output);
    if (!options.stats.empty()) require_writable(options.stats);
    check_colors(options);

    const Input input = options.tetrahedralize ? load_filled(options.input.file, options.surface) : load(options.input);
    const auto field = std::make_shared<const ScalarField>(choose_field(options, input));
    warn_of_values(*field);
    const Scene scene{input.mesh, field, choose_transfer(options, input, *field)};
    const std::vector<Camera> cameras = choose_cameras(options, input, size);

    RunStatistics run;
    run.once_ms.read = input.read_ms;
    run.once_ms.tetrahedralize = input.tetrahedralize_ms;
    const auto renderer = make_renderer(Backend::gl_osmesa);
    const Stopwatch preparing;
    {
        const Progress progress("preparing");
        renderer->prepare(scene, quality);
    }
    run.once_ms.prepare = preparing.ms();
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const std::filesystem::path file = numbered(options.output, i, cameras.size());
        const Progress progress("rendering " + file.string());
        Statistics statistics;
        const Image image = renderer->render(scene, cameras[i], size, quality, &statistics);
        const Stopwatch writing;
        write(image, file, options,
              {{"Software", "cellproj " CELLPROJ_VERSION},
               {"cellproj field", field->name},
               {"cellproj camera", to_json(cameras[i])},
               {"cellproj method", statistics.method},
               {"cellproj target", statistics.target},
               {"cellproj order", statistics.order},
               {"cellproj backend", statistics.backend + ", " + statistics.backend_version}});
        statistics.ms.write = writing.ms();
        warn(image, statistics, file);
        print_line(file, statistics);
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
    add_input_options(*command, options->input);
    command->add_option("-o,--output", options->output, "The picture: .png or .exr; several become NAME_000.png …")
        ->required();
    command->add_option("--field", options->field, "The field to draw (default: the first); vectors by magnitude, or U:x, U:y, U:z");
    command->add_option("--cell-values", options->cell_values, "How cell fields are drawn: constant in a cell, or averaged to the points")
        ->check(CLI::IsMember({"constant", "averaged"}))->capture_default_str();
    CLI::Option* transfer = command->add_option("--transfer", options->transfer,
                                                "Transfer function (JSON), FILE#NAME for one of several; default: --colors and --range");
    std::string presets;
    for (const std::string& name : preset_names()) presets += (presets.empty() ? "" : ", ") + name;
    const std::vector<CLI::Option*> chosen{
        command->add_option("--colors", options->colors, "Colours by name: " + presets)->capture_default_str(),
        command->add_option("--range", options->range,
                            "Scalars LOW,HIGH of the first and last colour; default: the field's 1-99 % range")
            ->expected(2)->delimiter(','),
        command->add_option("--axis", options->axis,
                            "What colour and opacity are spread over: the scalar (linear) or its logarithm (log)")
            ->check(CLI::IsMember({"linear", "log"}))->capture_default_str()};
    for (CLI::Option* option : chosen)
        option->excludes(transfer)->each([options](const std::string&) { options->colors_chosen = true; });
    command->add_option("--opacity-scale", options->opacity_scale, "Multiplies the extinction of any transfer function")
        ->check(CLI::Range(0.0, 1e9))->capture_default_str();
    CLI::Option* camera = command->add_option("--camera", options->camera, "Camera or array of cameras (JSON)");
    command->add_option("--from", options->from, "Direction from which the whole mesh is seen: X,Y,Z")
        ->expected(3)->delimiter(',')->capture_default_str()->excludes(camera);
    command->add_option("--up", options->up, "What appears upwards: X,Y,Z")
        ->expected(3)->delimiter(',')->capture_default_str()->excludes(camera);
    command->add_option("--projection", options->projection, "parallel or perspective")
        ->check(CLI::IsMember({"parallel", "perspective"}))->capture_default_str()->excludes(camera);
    command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
    command->add_option("--orbit", options->orbit_degrees, "Turn the camera by DEGREES in all, over --frames pictures")
        ->check(CLI::Range(-36000.0, 36000.0));
    command->add_option("--frames", options->frames, "Number of pictures of the orbit")->check(CLI::Range(1, 100000));
    command->add_option("--background", options->background, "Colour behind the volume in a PNG: R,G,B in 0..1")
        ->expected(3)->delimiter(',')->check(CLI::Range(0.0, 1.0))->capture_default_str();
    command->add_option("--bits", options->bits, "Bits per channel of a PNG: 8 or 16")
        ->check(CLI::IsMember({8, 16}))->capture_default_str();
    command->add_option("--method", options->method, "How a ray's piece in a cell becomes light: NAME[:CHOICE…] (classify/README.md)")
        ->capture_default_str();
    command->add_option("--target", options->target, "What cells are blended in: rgba8, rgba16, rgba16f or rgba32f")
        ->capture_default_str();
    command->add_option("--stats", options->stats, "Write times and counts of every picture (JSON); /dev/stdout prints them");
    command->add_option("--nan", options->nan, "Draw values that are not finite (NaN) as this one; default: leave their cells out")
        ->check(finite_number());
    CLI::Option* tetrahedralize = command->add_flag(
        "--tetrahedralize", options->tetrahedralize, "FILE is a surface: fill it with tetrahedra first, and render the inside");
    for (CLI::Option* option : add_surface_options(*command, options->surface, "a regular cell with edges of 1/40 of the diagonal"))
        option->needs(tetrahedralize);
    command->callback([options] { render_pictures(*options); });
}

}  // namespace cellproj::cli
