// SPDX-License-Identifier: BSD-3-Clause
//
// The texts of the shader files in render/gl/shaders, embedded at build time (embed_shaders.cmake).
#pragma once

#include <string>

namespace cellproj::gl::shaders {

extern const std::string cell_vert;
extern const std::string cell_frag;      // needs one of the following behind it
extern const std::string preint3d_glsl;
extern const std::string lit_vert;
extern const std::string lit_frag;

}  // namespace cellproj::gl::shaders
