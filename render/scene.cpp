// SPDX-License-Identifier: BSD-3-Clause
#include "render/scene.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

void validate(const TetMesh& mesh, const ScalarField& field) {
    const std::size_t rows = field.location == FieldLocation::points ? mesh.points.size() : mesh.tets.size();
    if (field.values.size() != rows) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", std::to_string(rows) + " values",
                     std::to_string(field.values.size()), "choose a field of this mesh"});
    }
    if (std::none_of(field.values.begin(), field.values.end(), [](double s) { return std::isfinite(s); })) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", "finite values", "none", "choose another field"});
    }
}

}  // namespace

bool has_surfaces(const Scene& scene) { return scene.surfaces && !scene.surfaces->isosurfaces.surfaces().empty(); }

bool has_lit_medium(const Scene& scene) { return scene.surfaces && scene.surfaces->lit_medium && scene.surfaces->shading != Shading::unlit; }

RayCuts ray_cuts(const Scene& scene) { return count_cuts(scene.clip.get(), scene.bodies.get(), scene.slices.get()); }

void validate(const Scene& scene) {
    assert(scene.mesh && scene.field && scene.transfer);
    const ScalarField& field = *scene.field;
    validate(*scene.mesh, field);
    if (scene.opacity_field) validate(*scene.mesh, *scene.opacity_field);
    if (scene.clip) validate(*scene.clip, "clip region");
    if (scene.bodies) validate(*scene.bodies);
    assert(!scene.slices || scene.slices->cuts.size() == scene.slices->slices.size());
    if (scene.slices) validate(*scene.slices);
    if (!has_surface_scene(scene)) return;
    if (field.location == FieldLocation::cells) {
        throw Error({ErrorKind::option, (has_surfaces(scene) ? "isosurfaces of field \"" : "light by the gradient of field \"") + field.name + "\"", "a field on points",
                     "one on cells, constant in each", "carry it to the points first (--cell-values averaged)"});
    }
    validate(scene.surfaces->lighting, "lights");
}

}  // namespace cellproj
