// SPDX-License-Identifier: BSD-3-Clause
#include "scene_options.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "classify/presets.hpp"
#include "mesh/error.hpp"
#include "mesh/scalar_field.hpp"

namespace cellproj::cli {

namespace {

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

double volume_of(const TetMesh& mesh) {
    double volume = 0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) volume += std::abs(signed_volume(mesh, cell));
    return volume;
}

double volume_of(const Grid& grid) {
    double volume = 0;
    const GridDimensions n = grid.dimensions();
    for (std::size_t k = 0; k + 1 < n.nk; ++k)
        for (std::size_t j = 0; j + 1 < n.nj; ++j)
            for (std::size_t i = 0; i + 1 < n.ni; ++i) {
                if (grid.is_blanked({i, j, k})) continue;
                const glm::dvec3 edges = grid.cell_edges({i, j, k});
                volume += edges.x * edges.y * edges.z;
            }
    return volume;
}

double volume_of(const GridHierarchy& hierarchy) {
    double volume = 0;
    for (const Grid& piece : hierarchy.pieces) volume += volume_of(piece);
    return volume;
}

// The mean length of the rays through a mesh over all that meet its box: 4 · volume / surface of the box (Cauchy). Thin and sparse
// meshes get more extinction by it than compact ones of the same diagonal.
double mean_path(double volume, const Bounds& box) {
    const glm::dvec3 edge = box.high - box.low;
    const double surface = 2 * (edge.x * edge.y + edge.y * edge.z + edge.z * edge.x);
    return volume > 0 && surface > 0 ? 4 * volume / surface : box.diagonal();
}

std::string in_words(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", number);
    return text;
}

struct ColorRange {
    double low, high;
};

// What most of the field lies in: the 1 % at each end are outliers more often than flow.
ColorRange usual_range(const ScalarField& field) {
    const ColorRange most{quantile(field.values, 0.01), quantile(field.values, 0.99)};
    if (most.low < most.high) return most;
    const auto whole = range(field.values);
    return {whole.low, whole.high};
}

ColorRange choose_range(const SceneOptions& options, const ScalarField& field) {
    return options.range.empty() ? usual_range(field) : ColorRange{options.range[0], options.range[1]};
}

// `volume`: of all cells. `opacity`: the opacity field, or null.
TransferFunction preset_transfer(const SceneOptions& options, const Input& input, double volume, const ScalarField& field,
                                 const ScalarField* opacity) {
    const auto [low, high] = choose_range(options, field);
    const bool log = options.axis == "log";
    if (log && !(low > 0)) {
        throw Error({ErrorKind::option, "--axis log", "a range above 0",
                     in_words(low) + " .. " + in_words(high) + " of field \"" + field.name + '"',
                     "give --range LOW,HIGH with LOW > 0"});
    }
    // A cube's diagonal is 2.6 times its mean path.
    const double size = 2.6 * mean_path(volume, bounds(input.mesh->points));
    const TransferFunction transfer =
        default_transfer_function(low, high, size, options.colors, log ? ScalarAxis::log : ScalarAxis::linear);
    if (!opacity) return transfer;
    const auto [low_opacity, high_opacity] = usual_range(*opacity);
    const TransferFunction over_opacity = default_transfer_function(low_opacity, high_opacity, size);
    return {transfer.model(), transfer.color_nodes(), over_opacity.extinction_nodes()};
}

std::shared_ptr<const TransferFunction> choose_transfer(const SceneOptions& options, const Input& input, double volume,
                                                        const ScalarField& field, const ScalarField* opacity) {
    const bool from_scene = input.transfer && options.field.empty() && !opacity && !options.colors_chosen;
    const TransferFunction transfer = !options.transfer.empty() ? read_transfer_function(options.transfer)
                                      : from_scene              ? *input.transfer
                                                                : preset_transfer(options, input, volume, field, opacity);
    return std::make_shared<TransferFunction>(with_scaled_extinction(transfer, options.opacity_scale));
}

// What can be refused without a mesh.
void check_colors(const SceneOptions& options) {
    preset_colors(options.colors, 0, 1, ScalarAxis::linear, "--colors");
    if (options.range.empty()) return;
    const double low = options.range[0], high = options.range[1];
    if (!(low <= high && std::max(-low, high) <= 1e150)) {
        throw Error({ErrorKind::option, "--range", "LOW,HIGH with LOW ≤ HIGH, of magnitude up to 1e150",
                     in_words(low) + "," + in_words(high), "correct it"});
    }
}

// Their colours are those of the volume, drawn or not.
void add_surfaces(const SceneOptions& options, Scene& scene) {
    auto surfaces = std::make_shared<const SurfaceScene>(parse_surfaces(options.iso, *scene.transfer));
    warn_of_missing(surfaces->isosurfaces, *scene.field);
    scene.surfaces = std::move(surfaces);
}

// Isosurfaces and slices alone are what is asked for unless something tells of the volume around them.
bool draws_volume(const SceneOptions& options) {
    return (!options.iso.any() && options.cuts.slices.empty()) || options.iso.volume || options.iso.shade_volume || options.opacity_chosen;
}

// Cell fields are exact as constants; averaged to the points they look smooth.
ScalarField load_field(const SceneOptions& options, const Input& input, const std::string& name) {
    ScalarField field = select_scalar(*input.mesh, name, input.name, input.report.added_points);
    if (options.nan) field = with_finite_values(std::move(field), *options.nan);
    const bool averaged = field.location == FieldLocation::cells && options.cell_values == "averaged";
    return averaged ? averaged_to_points(*input.mesh, field) : field;
}

ScalarField choose_field(const SceneOptions& options, const Input& input) {
    return load_field(options, input, options.field);
}

void warn_of_values(const ScalarField& field) {
    const std::size_t bad = range(field.values).not_finite;
    if (bad == 0) return;
    std::fprintf(stderr, "cellproj: warning: field \"%s\": %zu of %zu values are not finite; cells that touch them are left out\n",
                 field.name.c_str(), bad, field.values.size());
}

}  // namespace

SceneOptions::SceneOptions() : colors(preset_names().front()) {}

ImageSize require_possible(const SceneOptions& options) {
    check_colors(options);
    parse_surfaces(options.iso, TransferFunction(OpticalModel::density, {{0, glm::dvec3(0)}}, {{0, 0}}));
    parse_region(options.cuts);
    parse_slices(options.cuts);
    if (options.cuts.caps && options.cuts.planes.empty() && options.cuts.box.empty())
        throw Error({ErrorKind::option, "--caps", "a clip region to be closed", "none", "give --clip or --clip-box"});
    for (const std::string& surface : options.cuts.surfaces) parse_body(surface);
    require_shaded(options.iso, !options.cuts.surfaces.empty());
    return parse_size(options.size);
}

LoadedScene load_scene(const SceneOptions& options, DrawnAs drawn_as) {
    Input input = options.tetrahedralize ? load_filled(options.input.file, options.surface) : load(options.input, drawn_as);
    const auto field = std::make_shared<const ScalarField>(choose_field(options, input));
    warn_of_values(*field);
    std::shared_ptr<const ScalarField> opacity;
    if (!options.opacity_field.empty()) {
        opacity = std::make_shared<const ScalarField>(load_field(options, input, options.opacity_field));
        warn_of_values(*opacity);
    }
    std::shared_ptr<const Grid> regular;
    std::shared_ptr<const GridHierarchy> pieces;
    if (input.regular && !input.regular->pieces.empty()) pieces = std::make_shared<const GridHierarchy>(make_grid_hierarchy(*input.regular, *field));
    else if (input.regular) regular = std::make_shared<const Grid>(make_grid(*input.regular, *field));
    const double volume = pieces ? volume_of(*pieces) : regular ? volume_of(*regular) : volume_of(*input.mesh);
    Scene scene{.mesh = input.mesh,
                .field = field,
                .transfer = choose_transfer(options, input, volume, *field, opacity.get()),
                .opacity_field = opacity};
    if (options.iso.any_shaded()) add_surfaces(options, scene);
    add_cuts(options.cuts, parse_lighting(options.iso), scene.transfer, regular.get(), scene);
    if (!draws_volume(options)) {
        const TransferFunction nothing(OpticalModel::density, {{0, glm::dvec3(0)}}, {{0, 0}});
        scene.transfer = std::make_shared<const TransferFunction>(nothing);
    }
    std::optional<GridScene> grid;
    if (regular) grid = GridScene{std::move(regular), scene.transfer, scene.surfaces, scene.clip, scene.bodies, scene.slices};
    std::optional<HierarchyScene> hierarchy;
    if (pieces) hierarchy = HierarchyScene{std::move(pieces), scene.transfer};
    return {std::move(input), std::move(scene), std::move(grid), std::move(hierarchy)};
}

std::vector<Camera> choose_cameras(const SceneOptions& options, const Input& input, ImageSize size, bool turn) {
    std::vector<Camera> cameras;
    if (!options.camera.empty()) {
        cameras = read_cameras(options.camera);
    } else if (input.camera) {
        cameras = {*input.camera};
    } else {
        const auto frame = turn ? frame_sphere : frame_bounds;
        cameras = {frame(bounds(input.mesh->points),
                         options.projection == "parallel" ? Camera::Projection::parallel
                                                          : Camera::Projection::perspective,
                         vector3(options.from), vector3(options.up), static_cast<double>(size.width) / size.height)};
        validate(cameras.front(), "--from, --up");
    }
    return cameras;
}

void add_scene_options(CLI::App& command, SceneOptions& options) {
    add_input_options(command, options.input);
    command.add_option("--field", options.field, "The field to draw (default: the one that info suggests); vectors by magnitude, or U:x; Points:z: a coordinate");
    CLI::Option* opacity_field = command.add_option("--opacity-field", options.opacity_field,
                       "Read opacity over this field, and only colour over --field; default opacity: rising over the field's 1-99 % range");
    command.add_option("--cell-values", options.cell_values, "How cell fields are drawn: constant in a cell, or averaged to the points")
        ->check(CLI::IsMember({"constant", "averaged"}))->capture_default_str();
    CLI::Option* transfer = command.add_option("--transfer", options.transfer,
                                                "Transfer function (JSON), FILE#NAME for one of several; default: --colors and --range");
    std::string presets;
    for (const std::string& name : preset_names()) presets += (presets.empty() ? "" : ", ") + name;
    const std::vector<CLI::Option*> chosen{
        command.add_option("--colors", options.colors, "Colours by name: " + presets)->capture_default_str(),
        command.add_option("--range", options.range,
                            "Scalars LOW,HIGH of the first and last colour; default: the field's 1-99 % range")
            ->expected(2)->delimiter(','),
        command.add_option("--axis", options.axis,
                            "What colour and opacity are spread over: the scalar (linear) or its logarithm (log)")
            ->check(CLI::IsMember({"linear", "log"}))->capture_default_str()};
    for (CLI::Option* option : chosen)
        option->excludes(transfer)->each([&options](const std::string&) { options.colors_chosen = true; });
    CLI::Option* opacity_scale =
        command.add_option("--opacity-scale", options.opacity_scale, "Multiplies the extinction of any transfer function")
            ->check(CLI::Range(0.0, 1e9))->capture_default_str();
    for (CLI::Option* option : {transfer, opacity_field, opacity_scale})
        option->each([&options](const std::string&) { options.opacity_chosen = true; });
    CLI::Option* camera = command.add_option("--camera", options.camera, "Camera or array of cameras (JSON)");
    command.add_option("--from", options.from, "Direction from which the whole mesh is seen: X,Y,Z")
        ->expected(3)->delimiter(',')->capture_default_str()->excludes(camera);
    command.add_option("--up", options.up, "What appears upwards: X,Y,Z")
        ->expected(3)->delimiter(',')->capture_default_str()->excludes(camera);
    command.add_option("--projection", options.projection, "parallel or perspective")
        ->check(CLI::IsMember({"parallel", "perspective"}))->capture_default_str()->excludes(camera);
    command.add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
    command.add_option("--nan", options.nan, "Draw values that are not finite (NaN) as this one; default: leave their cells out")
        ->check(finite_number());
    CLI::Option* tetrahedralize = command.add_flag(
        "--tetrahedralize", options.tetrahedralize, "FILE is a surface: fill it with tetrahedra first, and render the inside");
    for (CLI::Option* option : add_surface_options(command, options.surface, "a regular cell with edges of 1/40 of the diagonal"))
        option->needs(tetrahedralize);
}

}  // namespace cellproj::cli
