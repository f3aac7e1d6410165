// SPDX-License-Identifier: BSD-3-Clause
//
// The texts of the shader files in render/gl/shaders, embedded at build time (embed_shaders.cmake).
#pragma once

#include <string>

namespace cellproj::gl::shaders {

extern const std::string cell_vert;
extern const std::string cell_frag;      // needs one of the following behind it
extern const std::string sampled_glsl;   // behind it: average, homogeneous, linear or stein
extern const std::string average_glsl;
extern const std::string homogeneous_glsl;
extern const std::string linear_glsl;
extern const std::string stein_glsl;
extern const std::string preint2d_glsl;
extern const std::string preint2d_exp_glsl;
extern const std::string preint3d_glsl;
extern const std::string preint3d_linear_glsl;
extern const std::string lit_vert;
extern const std::string lit_frag;

}  // namespace cellproj::gl::shaders
