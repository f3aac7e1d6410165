#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// The pixels that are not opaque yet: theirs is a depth, and nothing else.
layout(binding = 14) uniform sampler2D picture;  // so far
uniform float opaque;

void main() {
    if (texelFetch(picture, ivec2(gl_FragCoord.xy), 0).a > opaque) discard;
}
