// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: a hierarchy of grids out of the files of its pieces.
#pragma once

#include <string>
#include <vector>

#include "mesh/dataset.hpp"

namespace cellproj {

// The datasets of pieces, each a grid of boxes, as one: `Dataset::pieces`, and the hexahedra that no finer piece covers (those that are
// covered count as ghost cells). Throws Error as
// place_pieces and covered_cells, and (data) when a piece is no grid of boxes or lacks a field that another has.
Dataset assemble_pieces(std::vector<Dataset> pieces, std::vector<std::string> names, const std::string& place);

}  // namespace cellproj
