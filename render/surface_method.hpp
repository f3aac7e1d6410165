// SPDX-License-Identifier: BSD-3-Clause
//
// The ways to isosurfaces in a segment, by name. What each costs and how wrong it is: render/gl/README.md.
#pragma once

#include <string>
#include <string_view>

#include "classify/method.hpp"

namespace cellproj {

enum class SurfaceMethodKind {
    exact,    // the segment is cut at every crossing (RKE00 §10, exact); the usual one
    table,    // all surfaces of a segment by one lookup over (s_f, s_b) (RKE00 Fig. 6, 9, 13), as if they stood at the first one, where
              // the medium is cut (Fig. 15)
    combined  // by the same table, part before and part behind the whole medium of the segment (RKE00 §10, the smooth combination)
};

struct SurfaceMethod {
    SurfaceMethodKind kind = SurfaceMethodKind::exact;
    int size = 512;  // texels per axis of a table: isovalues are off by up to half of 1/(size − 1) of the field's range

    bool operator==(const SurfaceMethod&) const = default;
};

// Whether a method of light knows a place in a segment, so that isosurfaces can cut it there: those of light per pixel, blended once.
bool takes_surfaces(const Method& method);

// From "exact", "table", "table:N", "combined", "combined:N", N = 2 .. 2048. Throws Error (option), naming `place`.
SurfaceMethod parse_surface_method(std::string_view text, const std::string& place = "isosurface method");

// The text that parse_surface_method turns into this method; sizes are always said.
std::string to_string(const SurfaceMethod& method);

}  // namespace cellproj
