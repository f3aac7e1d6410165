// SPDX-License-Identifier: BSD-3-Clause
//
// What a picture needs, and nothing else: "model only what a scene requires". A pure function of scene, camera and quality; renderers
// do as it says, and `cellproj render --explain` prints it.
//
// What holds for all views of a scene is planned when a renderer prepares it, the rest for each view.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "classify/method.hpp"
#include "mesh/predicates.hpp"
#include "mesh/scalar_field.hpp"
#include "project/camera.hpp"
#include "render/gpu.hpp"
#include "render/plan_rules.hpp"
#include "render/renderer.hpp"

namespace cellproj {

// What plans are made from. Counts are numbers of cells.
struct SceneFacts {
    Bounds box{};                // of the mesh's points
    std::size_t cells = 0;
    std::size_t not_finite = 0;  // with a scalar that is not: never drawn
    std::size_t medium = 0;      // whose medium can be seen over the range of their scalars
    bool absorbs = false;        // some extinction over the range of the field
    bool constant_light = false; // one colour and one extinction over the range of the field
    FieldLocation location = FieldLocation::points;
    FieldsRead fields = FieldsRead::one;

    struct Surfaces {
        std::size_t count = 0;
        std::size_t crossed = 0;
        bool opaque = false;     // all of them
        bool jump = false;       // PreparedSurfaces::jump
        Shading shading = Shading::unlit;
    };
    std::optional<Surfaces> surfaces = {};
    std::optional<Shading> lit_medium = {};  // how, where a medium is seen and lit: flat or smooth

    // Whether any picture shows anything.
    bool seen() const { return medium > 0 || (surfaces && surfaces->crossed > 0); }
};

struct Plan {
    enum class Drawing {
        nothing,           // an empty picture, but for bodies and slices
        nearest_surfaces,  // cells with isosurfaces in any order; the nearest surface of each pixel is seen
        sum,               // cells in any order; their light adds up
        by_pixels,         // each pixel sorts what its ray meets
        by_cells           // cells in an order
    };
    Drawing drawing = Drawing::by_cells;
    bool few_cells = false;           // are drawn: pixels may sort what they meet; in by_pixels of a view they do, without a sorter
    Method method;                    // by which light of segments is computed
    std::vector<Decision> decisions;  // one for each rule, in the order of the work

    // Whether something hides something, and whether all cells are sorted for that.
    bool blends() const { return drawing == Drawing::by_pixels || drawing == Drawing::by_cells; }
    bool sorts() const { return blends() && !(drawing == Drawing::by_pixels && few_cells); }
};

// For all views of a scene. The quality is one that the backend draws.
Plan plan_scene(const SceneFacts& facts, const Quality& quality, Backend backend, const PlanRules& rules = {});
// The same for one view of it.
Plan plan_view(Plan plan, const SceneFacts& facts, const Camera& camera, ImageSize size, const RayCuts& cuts, const PlanRules& rules = {});

// What of the rays is left, for meshes and grids.
Decision decide_rays(const RayCuts& cuts);

// All of it, from the scene itself. Throws Error as `Renderer::render` does.
Plan plan(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality, Backend backend);

// How many segments the rays of the picture have in `cells` of the scene's cells, were they all alike: the mean area of a cell on the
// screen (a regular one's, a quarter of its surface by Cauchy's formula) where the middle of the mesh is. 0 or more.
double expected_fragments(const SceneFacts& facts, std::size_t cells, const Camera& camera, ImageSize size);

// Whether no ray of the view meets the box, told from the box's corners: true only where it is so.
bool outside_view(const Bounds& box, const Camera& camera, ImageSize size);

// What a user may ask for: a backend, `gl` for OpenGL on a GPU or else on the CPU, or the one that serves best.
enum class BackendWish { automatic, cpu, gl, egl, osmesa };
// "auto", "cpu", "gl", "egl", "osmesa". Throws Error (option) for another name.
BackendWish parse_backend(const std::string& name, const std::string& place = "--backend");
// Whether the choice depends on the GPU of the machine: who need not ask for it should not.
bool depends_on_gpu(BackendWish wish);

// The backend for pictures of this quality, whether it draws them or not.
Backend wished_backend(BackendWish wish, const Quality& quality, FieldsRead fields, const Gpu& gpu);

struct ChosenBackend {
    Backend backend;
    Decision decision;
};
// Throws Error (option) when the backend does not draw pictures of this quality.
ChosenBackend choose_backend(BackendWish wish, const Quality& quality, FieldsRead fields, const Gpu& gpu);

// Completes the decision on the order by what the sorter then took, as statistics call it.
void tell_order(std::vector<Decision>& decisions, const std::string& method, bool exact);

// A table of columns, a line for each decision.
std::string in_words(std::span<const Decision> decisions);

}  // namespace cellproj
