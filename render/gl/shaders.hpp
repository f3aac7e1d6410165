// SPDX-License-Identifier: BSD-3-Clause
//
// The texts of the shader files in render/gl/shaders, embedded at build time (embed_shaders.cmake).
#pragma once

#include <string>

namespace cellproj::gl::shaders {

extern const std::string cell_vert;
extern const std::string preintegrated_frag;

}  // namespace cellproj::gl::shaders
