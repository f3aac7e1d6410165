// SPDX-License-Identifier: BSD-3-Clause
//
// VTK's ray caster of images, as a user with its documentation would set it:
// - scalars in float, colour and opacity with a node at every breakpoint of ours, opacity linear in the extinction over one
//   unit distance small enough that VTK's exponential correction makes no difference;
// - every pixel, a fixed sample distance, no shading, all CPUs, no depth buffer of other things, no cropping.
#pragma once

#include <memory>

#include "classify/transfer_function.hpp"
#include "mesh/grid.hpp"
#include "project/camera.hpp"
#include "render/image.hpp"

namespace cellproj::bench {

class VtkFixedPoint {
public:
    // A grid with uniform axes and a field on points. `step`: the sample distance [cells]. Draws on the display that
    // DISPLAY names.
    VtkFixedPoint(const Grid& grid, const TransferFunction& transfer, ImageSize size, double step);
    ~VtkFixedPoint();

    void draw(const Camera& camera);  // a whole frame
    Image picture() const;            // the last one, 8 bits, opacity unknown (0)

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace cellproj::bench
