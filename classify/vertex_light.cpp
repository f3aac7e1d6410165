// SPDX-License-Identifier: BSD-3-Clause
#include "classify/vertex_light.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "classify/segment_method.hpp"
#include "classify/shirley_tuchman.hpp"

namespace cellproj {

namespace {

class ShirleyTuchmanLighting : public VertexLighting {
public:
    ShirleyTuchmanLighting(const TransferFunction& transfer, double max_length)
        : method_(transfer), max_length_(max_length) {}

    VertexLight at_thick_vertex(double s_f, double s_b, double length) const override {
        return method_.at(s_f, s_b, std::clamp(length, 0.0, max_length_));
    }
    glm::dvec3 color_at_silhouette(double s, const VertexLight& /*thick*/) const override { return method_.color(s); }
    std::size_t table_bytes() const override { return method_.table_bytes(); }

private:
    ShirleyTuchman method_;
    double max_length_;
};

class GouraudLighting : public VertexLighting {
public:
    GouraudLighting(std::unique_ptr<SegmentMethod> method, double max_length)
        : method_(std::move(method)), max_length_(max_length) {}

    VertexLight at_thick_vertex(double s_f, double s_b, double length) const override {
        const Light light = method_->light(s_f, s_b, std::clamp(length, 0.0, max_length_));
        return {light.color, 1.0, light.opacity};
    }
    glm::dvec3 color_at_silhouette(double /*s*/, const VertexLight& thick) const override { return thick.color; }
    std::size_t table_bytes() const override { return method_->table_bytes(); }

private:
    std::unique_ptr<SegmentMethod> method_;
    double max_length_;
};

}  // namespace

std::unique_ptr<VertexLighting> make_vertex_lighting(const Method& method, const TransferFunction& transfer,
                                                     double max_length, double mean_length) {
    assert(light_at_vertices(method));
    if (method.kind == MethodKind::shirley_tuchman)
        return std::make_unique<ShirleyTuchmanLighting>(transfer, max_length);
    // Blending comes after the interpolation, in the pixel.
    Method at_thick = method;
    at_thick.interpolation = Interpolation::pixels;
    at_thick.blending = Blending::once;
    return std::make_unique<GouraudLighting>(make_segment_method(at_thick, transfer, max_length, mean_length), max_length);
}

}  // namespace cellproj
