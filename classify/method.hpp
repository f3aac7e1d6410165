// SPDX-License-Identifier: BSD-3-Clause
//
// The ways to the light of a segment, by name. What each computes, how wrong it is and what its tables weigh stands in
// classify/README.md; segment_method.hpp computes it.
#pragma once

#include <string>
#include <string_view>

namespace cellproj {

enum class MethodKind {
    shirley_tuchman,  // light at the vertices of the classical split, colour and opacity interpolated linearly
    average,          // WVG91 Eq. 9–10: mean colour C times optical depth D of the ends' means
    homogeneous,      // WVG91: exponential, one mean emission and extinction per segment
    linear,           // WVG91: exponential, N homogeneous steps along a linear scalar
    stein,            // RKE00 §2: opacity from (τ, l), colour the mean of both ends
    preint2d,         // RKE00 §4: table over (s_f, s_b) at the mean length, scaled by l / mean length
    preint2d_exp,     // EKE01 Eq. 8–10: table over (s_f, s_b) of mean colour and mean extinction, exact in l
    preint3d,         // RKE00 §3: table over (s_f, s_b, l)
    integral,         // 1D running integrals: opacity exact, colour with a correction for self-attenuation
    exact             // cut at the nodes of the transfer function, each part to a tolerance
};

// Where light is computed: for each pixel, or at the vertices of the classical split and interpolated linearly (WVG91
// calls that Gouraud).
enum class Interpolation { pixels, vertices };

// Texels of a table along l: evenly spaced (RKE00 §3), or evenly in ln l.
enum class TableScale { linear, logarithmic };

// What a texel of a table is kept in.
enum class TableStorage { uint8, float16, float32 };

// How a cell is blended over what is behind it: in one pass, or as by the three passes of WVG91 §3.2, half of the opacity
// before and half after its colour (half_opacity.hpp).
enum class Blending { once, half };

// One method with its choices; those that its kind has no use for keep their defaults.
struct Method {
    MethodKind kind = MethodKind::integral;
    int size = 64;            // texels per axis of a table; steps of `linear`
    double tolerance = 1e-5;  // of `exact`: largest error of a colour channel or the opacity of a segment
    TableScale scale = TableScale::logarithmic;
    TableStorage storage = TableStorage::float32;
    Interpolation interpolation = Interpolation::pixels;
    Blending blending = Blending::once;

    bool operator==(const Method&) const = default;
};

// Whether the renderer computes light at the vertices (vertex_light.hpp) instead of for each pixel (segment_method.hpp).
inline bool light_at_vertices(const Method& method) {
    return method.kind == MethodKind::shirley_tuchman || method.interpolation == Interpolation::vertices;
}

// Whether the method can take colour and extinction from two scalars: those that sample the function or walk through its pieces for
// each pixel. Tables over (s_f, s_b) would need two more axes.
inline bool takes_opacity_field(const Method& method) {
    const bool table = method.kind == MethodKind::preint2d || method.kind == MethodKind::preint2d_exp ||
                       method.kind == MethodKind::preint3d;
    return !table && !light_at_vertices(method);
}

// From "NAME" or "NAME:PART:PART…", parts in any order: "integral", "preint3d:128:linear:uint8", "linear:8:vertices",
// "average:half", "exact:1e-6". What is not said has its default. Throws Error (option), naming `place`, for an unknown
// name or part (the nearest known one is told), a part that the method has no use for, and a number out of its range.
Method parse_method(std::string_view text, const std::string& place = "method");

// The text that parse_method turns into this method; sizes and tolerances are always said.
std::string to_string(const Method& method);

}  // namespace cellproj
