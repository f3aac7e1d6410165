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

void validate(const Scene& scene) {
    assert(scene.mesh && scene.field && scene.transfer);
    validate(*scene.mesh, *scene.field);
    if (scene.opacity_field) validate(*scene.mesh, *scene.opacity_field);
}

}  // namespace cellproj
