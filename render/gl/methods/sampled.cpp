// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>
#include <utility>
#include <vector>

#include "classify/sampled_function.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/shaders.hpp"
#include "render/gl/textures.hpp"

namespace cellproj::gl {

namespace {

struct Uniform {
    const char* name;
    float value;
};

class SampledShader : public SegmentShader {
public:
    SampledShader(const std::string& source, Sampled sampled, std::vector<Uniform> choices,
                  const TransferFunction& transfer)
        : source_(shaders::sampled_glsl + source),
          sampled_(sampled),
          choices_(std::move(choices)),
          samples_(Texture::list(SampledFunction(transfer, sampled).texels())) {}

    const std::string& source() const override { return source_; }

    bool update(const TransferFunction& transfer) override {
        // What the samples of `stein` mean depends on the optical model.
        if (sampled_ == Sampled::color) return false;
        samples_ = Texture::list(SampledFunction(transfer, sampled_).texels());
        return true;
    }

    void bind(const Program& program) const override {
        for (const Uniform& choice : choices_) program.set(choice.name, choice.value);
        samples_.bind(0);
    }

    std::size_t table_bytes() const override { return samples_.bytes(); }

private:
    std::string source_;
    Sampled sampled_;
    std::vector<Uniform> choices_;
    Texture samples_;
};

}  // namespace

std::unique_ptr<SegmentShader> make_sampled_shader(const Method& method, const TransferFunction& transfer, FieldsRead fields) {
    const bool density = transfer.model() == OpticalModel::density, two = fields == FieldsRead::two;
    // Of two fields no sample knows the emission: it is made of both in the fragment.
    const auto make = [&](const std::string& source, Sampled sampled, std::vector<Uniform> choices = {}) {
        if (two) choices.push_back({"is_product", density && sampled == Sampled::emission ? 1.0F : 0.0F});
        return std::make_unique<SampledShader>(source, two ? Sampled::color : sampled, std::move(choices), transfer);
    };
    switch (method.kind) {
        case MethodKind::average:
            return make(shaders::average_glsl, Sampled::emission);
        case MethodKind::homogeneous:
            return make(shaders::homogeneous_glsl, Sampled::emission);
        case MethodKind::linear:
            return make(shaders::linear_glsl, Sampled::emission, {{"steps", static_cast<float>(method.size)}});
        default:
            break;
    }
    assert(method.kind == MethodKind::stein);
    return make(shaders::stein_glsl, Sampled::color, {{"by_chromaticity", density ? 1.0F : 0.0F}});
}

}  // namespace cellproj::gl
