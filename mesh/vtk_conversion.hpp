// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: what the readers share. Names VTK's classes but includes none of its headers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mesh/dataset.hpp"

class vtkAlgorithm;
class vtkDataArray;
class vtkPoints;

namespace cellproj {

// Runs reader.Update() on `file`. VTK tells its readers' errors to the terminal and returns what it has got so far:
// here they become Error (format) with the first message, as do the exceptions of its allocations. Nothing reaches the
// terminal. Not reentrant; other threads wait, as VTK has one place for messages only (theirs are caught, too, while a
// file is read).
void update(vtkAlgorithm& reader, const std::filesystem::path& file);

// Throws Error (file) unless `file` can be opened and is a regular file, Error (format) when it is empty.
void require_readable(const std::filesystem::path& file);

// With dots for control characters and bytes beyond ASCII: fit for messages.
std::string printable(std::string text);

// At most `count` bytes of a file from `offset` on; fewer where it ends.
std::string read_bytes(const std::filesystem::path& file, std::uint64_t offset, std::size_t count);

// Throws Error (data) when there are more points than ids or one is not finite.
std::vector<glm::dvec3> to_points(vtkPoints& points, const std::filesystem::path& file);

// The given rows of an array, 0-based and below its length.
Field to_field(vtkDataArray& array, const std::string& name, std::span<const std::uint64_t> rows);
// All of them.
Field to_field(vtkDataArray& array, const std::string& name);

// legacy_cells.cpp: VTK's legacy reader follows the vertex counts of the cells without a look at how long the list is,
// and crashes where they are wrong. Throws Error (format) for such a list.
void require_sound_legacy_cells(const std::filesystem::path& file);

// PLOT3D, read_plot3d.cpp: a single-block binary grid and, unless `solution` is empty, its fields.
bool has_plot3d_suffix(const std::filesystem::path& file);
Dataset read_plot3d(const std::filesystem::path& file, const std::filesystem::path& solution);

}  // namespace cellproj
