// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Whether the seeds of regions are where their user thinks.
#pragma once

#include <string>
#include <vector>

#include "mesh/mesher.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// `parts` is a mesh of all that is to be filled, with the number of its enclosed part at each cell (cell field "region").
// TetGen crashes when it is given a seed outside, and says nothing about two in one part. Throws Error (data), naming
// `place`, for both. Exact predicates.
void require_seeds(const TetMesh& parts, const std::vector<Region>& regions, const std::string& place);

}  // namespace cellproj
