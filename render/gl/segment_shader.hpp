// SPDX-License-Identifier: BSD-3-Clause
//
// A method of classify/method.hpp in a fragment: the GLSL function
//
//   vec4 light_of_segment(float s_front, float s_back, float segment)   // associated colour, opacity; scene units
//
// with the tables and uniforms it reads. For a scene with an opacity field the scalars are vec2: that of the colour, that of the
// extinction (TWO_FIELDS in shaders/cell.frag). It goes behind shaders/cell.frag. Texture units 0 to 7 are its own.
#pragma once

#include <memory>
#include <string>

#include "classify/method.hpp"
#include "classify/transfer_function.hpp"
#include "render/gl/objects.hpp"
#include "render/scene.hpp"

namespace cellproj::gl {

class SegmentShader {
public:
    virtual ~SegmentShader() = default;

    virtual const std::string& source() const = 0;
    // Makes it the shader of another function, in the same scene units, with the same source(), at less cost than a new
    // one. False, and nothing has changed, when it cannot.
    virtual bool update([[maybe_unused]] const TransferFunction& transfer) { return false; }
    // What goes behind shaders/cell.vert: void prepare_cell(float low, float high), called at every vertex with the lowest
    // and highest scalar of its cell, with flat outputs for the fragments. Unless overridden it does nothing.
    virtual const std::string& vertex_source() const;
    // Sets the uniforms of `program`, which holds the source, and binds the textures.
    virtual void bind(const Program& program) const = 0;
    virtual std::size_t table_bytes() const = 0;
};

// The parameters are those of make_segment_method (classify/segment_method.hpp). Two fields: only for methods that take them
// (takes_opacity_field).
std::unique_ptr<SegmentShader> make_segment_shader(const Method& method, const TransferFunction& transfer, FieldsRead fields,
                                                   double max_length, double mean_length);

// One per family of methods, in methods/.
std::unique_ptr<SegmentShader> make_sampled_shader(const Method& method, const TransferFunction& transfer, FieldsRead fields);
std::unique_ptr<SegmentShader> make_piece_shader(const Method& method, const TransferFunction& transfer,  // integral, exact
                                                 FieldsRead fields, double max_length);
std::unique_ptr<SegmentShader> make_preint2d_shader(const Method& method, const TransferFunction& transfer,
                                                    double mean_length);
std::unique_ptr<SegmentShader> make_preint2d_exp_shader(const Method& method, const TransferFunction& transfer);
std::unique_ptr<SegmentShader> make_preint3d_shader(const Method& method, const TransferFunction& transfer,
                                                    double max_length);

}  // namespace cellproj::gl
