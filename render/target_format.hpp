// SPDX-License-Identifier: BSD-3-Clause
//
// What a picture is accumulated in. The picture that is handed out is float32 in any case.
//
//   rgba8, rgba16   fixed point, 0..1: each blending rounds to 1/255 or 1/65535, and brighter colours are cut to 1 before
//                   they are blended. What is less than half a step per layer is lost (rgba8) or is rounded in every layer.
//   rgba16f         11 binary digits, up to 65504: layers thinner than 2⁻¹¹ of what is there already are lost
//   rgba32f         24 binary digits: the default
//
// tests/target_format_test.cpp holds each to the arithmetic of its format.
#pragma once

#include <string>
#include <string_view>

namespace cellproj {

enum class TargetFormat { rgba8, rgba16, rgba16f, rgba32f };

// From its name above. Throws Error (option), naming `place`; the nearest known name is told.
TargetFormat parse_target_format(std::string_view text, const std::string& place = "target");

std::string to_string(TargetFormat format);

}  // namespace cellproj
