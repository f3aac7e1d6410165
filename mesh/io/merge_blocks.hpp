// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: the blocks of one file as one dataset.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh/dataset.hpp"

namespace cellproj {

// The cells of a curvilinear grid one by one, in its order (i fastest), as hexahedra in VTK's order of corners.
CellList hexahedra_of(const GridDimensions& grid);

// All blocks in one, in their order. Points are put one after the other and never merged, so neighbouring blocks stay
// unconnected; curvilinear grids become hexahedra, except a single one. A field is known by its name and its number of
// components (the first block that has it decides); where a block lacks it, its rows are NaN. `source` and `format` are
// those of the first block; skipped and ghost cells are summed. Throws Error (data), naming `file`, when there are more
// points than ids.
Dataset merge_blocks(std::vector<Dataset> blocks, const std::filesystem::path& file);

// Whether the block called `name` ("fluid/internalMesh") is chosen by one of `wanted`: by its whole name, by all of its
// first or by all of its last parts ("fluid", "internalMesh"). Everything is when `wanted` is empty.
bool is_chosen(const std::string& name, std::span<const std::string> wanted);

// Throws Error (option) when one of `wanted` chooses none of `names`, the volume blocks of `file`.
void require_known_blocks(std::span<const std::string> wanted, std::span<const std::string> names,
                          const std::filesystem::path& file);

}  // namespace cellproj
