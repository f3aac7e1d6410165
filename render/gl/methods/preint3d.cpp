// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "classify/preintegration_table.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/shaders.hpp"
#include "render/gl/textures.hpp"

namespace cellproj::gl {

namespace {

class Preint3dShader : public SegmentShader {
public:
    explicit Preint3dShader(const PreintegrationTable& table)
        : size_(table.size()),
          length_scale_(table.length_scale()),
          longest_(table.domain().max_length),
          texture_(Texture::table_3d(size_, TableStorage::float32, table.texels())) {}

    const std::string& source() const override { return shaders::preint3d_glsl; }

    void bind(const Program& program) const override {
        program.set("table_size", static_cast<float>(size_));
        program.set("inverse_length_scale", static_cast<float>(1.0 / length_scale_));
        program.set("inverse_log_range", static_cast<float>(1.0 / std::log2(1.0 + longest_ / length_scale_)));
        texture_.bind(0);
    }

    std::size_t table_bytes() const override { return texture_.bytes(); }

private:
    int size_;
    double length_scale_, longest_;
    Texture texture_;
};

}  // namespace

std::unique_ptr<SegmentShader> make_preint3d_shader(const Method& method, const TransferFunction& transfer,
                                                    double max_length) {
    return std::make_unique<Preint3dShader>(PreintegrationTable(transfer, {0.0, 1.0, max_length}, method.size));
}

}  // namespace cellproj::gl
