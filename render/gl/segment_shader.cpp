// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/segment_shader.hpp"

#include <cassert>

#include "render/gl/shaders.hpp"

namespace cellproj::gl {

const std::string& SegmentShader::vertex_source() const { return shaders::no_cell_glsl; }

std::unique_ptr<SegmentShader> make_segment_shader(const Method& method, const TransferFunction& transfer, FieldsRead fields,
                                                   double max_length, double mean_length) {
    assert(max_length > 0.0 && mean_length > 0.0);
    assert(fields == FieldsRead::one || takes_opacity_field(method));
    switch (method.kind) {
        case MethodKind::average:
        case MethodKind::homogeneous:
        case MethodKind::linear:
        case MethodKind::stein:
            return make_sampled_shader(method, transfer, fields);
        case MethodKind::preint2d:
            return make_preint2d_shader(method, transfer, mean_length);
        case MethodKind::preint2d_exp:
            return make_preint2d_exp_shader(method, transfer);
        case MethodKind::preint3d:
            return make_preint3d_shader(method, transfer, max_length);
        case MethodKind::integral:
        case MethodKind::exact:
            return make_piece_shader(method, transfer, fields, max_length);
        default:
            assert(false && "no such method");
            return nullptr;
    }
}

}  // namespace cellproj::gl
