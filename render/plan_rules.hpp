// SPDX-License-Identifier: BSD-3-Clause
//
// The rules of a plan (render/plan.hpp) and what they decide, in words.
#pragma once

#include <string>

namespace cellproj {

// One decision, as `cellproj render --explain` prints it.
struct Decision {
    std::string rule;    // what is decided: "order"
    std::string chosen;  // "none: nearest surface of each pixel"
    std::string why;
};

// Rules that leave out work without changing the picture. All hold; tests and benchmarks draw without one of them, to see that the
// picture is the same and what it saves.
struct PlanRules {
    bool empty_view = true;        // the mesh lies outside the view: an empty picture at once
    bool nothing_seen = true;      // no cell can be seen: likewise
    bool culling = true;           // cells that cannot be seen are left out before sorting
    bool nearest_surfaces = true;  // opaque isosurfaces alone: no order
    bool sum = true;               // nothing absorbs: no order
    bool few_cells = true;         // CPU: few cells are drawn: pixels sort what they meet instead of all cells being sorted
    bool constant_light = true;    // colour and extinction the same everywhere: a closed form instead of the method's tables and pieces
    bool front_to_back = true;     // OpenGL, grids: what may become opaque is drawn front to back, until it is
};

}  // namespace cellproj
