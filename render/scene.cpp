// SPDX-License-Identifier: BSD-3-Clause
#include "render/scene.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "mesh/error.hpp"

namespace cellproj {

void validate(const Scene& scene) {
    assert(scene.mesh && scene.field && scene.transfer);
    const ScalarField& field = *scene.field;
    const std::size_t rows = field.location == FieldLocation::points ? scene.mesh->points.size() : scene.mesh->tets.size();
    if (field.values.size() != rows) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", std::to_string(rows) + " values",
                     std::to_string(field.values.size()), "choose a field of this mesh"});
    }
    if (std::none_of(field.values.begin(), field.values.end(), [](double s) { return std::isfinite(s); })) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", "finite values", "none", "choose another field"});
    }
}

}  // namespace cellproj
