// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <utility>

#include "classify/preintegration_table.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/shaders.hpp"
#include "render/gl/textures.hpp"

namespace cellproj::gl {

namespace {

Texture upload(const PreintegrationTable& table) {
    const TableEncoding& encoding = table.encoding();
    return Texture::table_3d(table.size(), encoding.storage(), encoding.stored(table.texels()));
}

class Preint3dShader : public SegmentShader {
public:
    explicit Preint3dShader(PreintegrationTable table) : table_(std::move(table)), texture_(upload(table_)) {}

    const std::string& source() const override {
        return table_.scale() == TableScale::linear ? shaders::preint3d_linear_glsl : shaders::preint3d_glsl;
    }

    bool update(const TransferFunction& transfer) override {
        if (table_.update(transfer) > 0) texture_ = upload(table_);
        return true;
    }

    void bind(const Program& program) const override {
        program.set("table_size", static_cast<float>(table_.size()));
        program.set("table_range", table_.encoding().range());
        const double longest = table_.domain().max_length, scale = table_.length_scale();
        if (table_.scale() == TableScale::linear) {
            program.set("inverse_longest", static_cast<float>(1.0 / longest));
        } else {
            program.set("inverse_length_scale", static_cast<float>(1.0 / scale));
            program.set("inverse_log_range", static_cast<float>(1.0 / std::log2(1.0 + longest / scale)));
        }
        texture_.bind(0);
    }

    std::size_t table_bytes() const override { return texture_.bytes(); }

private:
    PreintegrationTable table_;
    Texture texture_;
};

}  // namespace

std::unique_ptr<SegmentShader> make_preint3d_shader(const Method& method, const TransferFunction& transfer,
                                                    double max_length) {
    return std::make_unique<Preint3dShader>(
        PreintegrationTable(transfer, {0.0, 1.0, max_length}, method.size, method.scale, method.storage));
}

}  // namespace cellproj::gl
