// SPDX-License-Identifier: BSD-3-Clause
//
// What draws the isosurfaces that cellproj_isosurfaces compares.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "project/camera.hpp"
#include "render/scene.hpp"

namespace cellproj::bench {

// Which values: at the quantiles i/(count + 1) of the field; so close to its median that they cross the same cells but for a few; or
// one at a quantile.
enum class IsoPlaces : std::int32_t { quantiles, same_cells, one };

// Isosurfaces of a field to be drawn. Trivially copyable: it goes through pipes.
struct IsoTask {
    IsoPlaces places = IsoPlaces::quantiles;
    std::int32_t count = 1;
    double quantile = 0.5;  // of `one`
    double opacity = 1.0;
    Shading shading = Shading::smooth;
    bool medium = false;  // a ramp around them
};

class IsoContender {
public:
    virtual ~IsoContender() = default;
    // The surfaces of frames from now on: what is done for them before a view is known. `scene` may be forgotten behind this.
    virtual void set(const Scene& scene) = 0;
    virtual void draw(const Camera& camera) = 0;
    // What it draws instead of cells; 0 for those that draw cells.
    virtual std::size_t triangles() const { return 0; }
};

// "cpu", "gl", "gl-table" and "gl-combined" (of 512² texels) and, built with VTK, "vtk".
std::vector<std::string> iso_contender_names();
std::unique_ptr<IsoContender> make_iso_contender(const std::string& name, ImageSize size);

// VTK's contour filter and its polygons, as a user with the documentation would set them: normals from the filter, translucent ones by
// depth peeling to the last layer (no limit of peels). Draws on the display that DISPLAY names.
std::unique_ptr<IsoContender> make_vtk_contours(ImageSize size);

}  // namespace cellproj::bench
