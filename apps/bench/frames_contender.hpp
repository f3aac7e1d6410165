// SPDX-License-Identifier: BSD-3-Clause
//
// What draws the frames that are compared.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "project/camera.hpp"
#include "render/image.hpp"
#include "render/renderer.hpp"
#include "render/statistics.hpp"

namespace cellproj::bench {

// Made with the mesh in the form that it reads, which is neither timed nor counted as its memory; then `set_up` once.
class Contender {
public:
    virtual ~Contender() = default;
    virtual void set_up() = 0;
    // A whole frame, all of it when this returns.
    virtual void draw(const Camera& camera) = 0;
    // Draws and says what the frame was made of, which takes longer: the order is proven, too. Nothing is told where the contender cannot.
    virtual Statistics explain(const Camera&) { return {}; }
    // The last frame: associated colour; opacity where it is known, else 0.
    virtual Image picture() const = 0;
    // Where its rays pass, from the centre of the pixel [pixels; x to the right, y down].
    virtual glm::dvec2 ray_shift() const { return {0, 0}; }
};

struct ContenderOptions {
    ImageSize size;
    Quality quality;  // of ours; VTK's have none
    int threads = 0;  // 0: all
};

// The names of all that this program was built with: "cpu", "cpu-pixel" (each pixel sorts for itself), "gl" (OSMesa), and with
// VTK its mappers. Those of VTK draw on the display that DISPLAY names.
std::vector<std::string> contender_names();
bool needs_display(const std::string& name);
std::unique_ptr<Contender> make_contender(const std::string& name, Scene scene, const ContenderOptions& options);

}  // namespace cellproj::bench
