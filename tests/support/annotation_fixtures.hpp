// SPDX-License-Identifier: BSD-3-Clause
//
// Scenes and pictures that the tests of annotations share.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "render/annotation/text.hpp"
#include "render/image.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj::testing_support {

inline std::shared_ptr<const Font> font() {
    static const auto shared = std::make_shared<const Font>();
    return shared;
}

// A field 0..1 (`scale` times it, plus `offset`) in the unit cube.
inline Scene scene_with(TransferFunction transfer, double scale = 1, double offset = 0, const std::string& name = "p") {
    const TetMesh mesh = grid_mesh(3);
    ScalarField field = point_field(mesh, [&](const glm::dvec3& p) { return offset + scale * linear(p); });
    field.name = name;
    return scene_of(mesh, std::move(field), std::move(transfer));
}

// Every channel of every pixel differs from any other one, and none is empty.
inline Image numbered_picture(ImageSize size, float alpha = 0.5F) {
    Image image(size.width, size.height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = {1e-6F * static_cast<float>(i % 100000), 0.125F, 0.25F, alpha};
    return image;
}

inline bool same(const glm::vec4& a, const glm::vec4& b) { return a == b; }

// With a step in colour and one in extinction.
inline const TransferFunction peaks{OpticalModel::density, {{0.1, {0.1, 0.2, 0.9}}, {0.5, {1.0, 0.6, 0.0}}, {0.5, {0.0, 0.6, 0.2}}, {0.9, {1, 1, 1}}},
                             {{0.2, 0}, {0.4, 3}, {0.6, 0}, {0.6, 1}, {0.9, 2}}};

}  // namespace cellproj::testing_support
