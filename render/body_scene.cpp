// SPDX-License-Identifier: BSD-3-Clause
#include "render/body_scene.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "mesh/error.hpp"

namespace cellproj {

Body make_body(const Surface& surface, const glm::dvec3& color) {
    validate(surface);
    return {surface.points, triangles_of(surface), color};
}

void validate(const BodyScene& scene) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Body& body = scene.bodies[i];
        const std::string place = "body " + std::to_string(i);
        for (const glm::dvec3& p : body.points)
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
                throw Error({ErrorKind::data, place, "finite points", "one that is not", "repair the surface"});
        for (const auto& triangle : body.triangles)
            for (const VertexId v : triangle)
                if (v >= body.points.size())
                    throw Error({ErrorKind::data, place, "vertices below " + std::to_string(body.points.size()), std::to_string(v),
                                 "repair the surface"});
    }
    validate(scene.lighting, "lights of bodies");
}

}  // namespace cellproj
