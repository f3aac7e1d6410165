// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: what the readers share. Names VTK's classes but includes none of its headers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "mesh/dataset.hpp"
#include "mesh/io/file_bytes.hpp"

class vtkAlgorithm;
class vtkDataArray;
class vtkDataSetAttributes;
class vtkPoints;
class vtkUnstructuredGrid;

namespace cellproj {

// Runs reader.Update() on `file`. VTK tells its readers' errors to the terminal and returns what it has got so far:
// here they become Error (format) with the first message, as do the exceptions of its allocations. Nothing reaches the
// terminal. Not reentrant; other threads wait, as VTK has one place for messages only (theirs are caught, too, while a
// file is read). Tells report_progress (isolated_read.hpp).
void update(vtkAlgorithm& reader, const std::filesystem::path& file);
// The same for any work with VTK's readers. std::bad_alloc is let through.
void capture_errors(const std::filesystem::path& file, const std::function<void()>& work);

// vtk_threads.cpp: VTK works on this thread only from now on: in a forked child the pool of threads it had (TBB's) is gone.
void use_one_thread();

// Throws Error (data) when there are more points than ids or one is not finite.
std::vector<glm::dvec3> to_points(vtkPoints& points, const std::filesystem::path& file);

// The given rows of an array, 0-based and below its length.
Field to_field(vtkDataArray& array, const std::string& name, std::span<const std::uint64_t> rows);
// All of them.
Field to_field(vtkDataArray& array, const std::string& name);

// The arrays of numbers of `attributes`, each of `rows` rows, converted by `convert(array, name)` and removed one after
// the other, so that few of them are held twice; texts and ghost marks are left out and stay where they are. Throws Error (format) when an array has another number of rows.
std::vector<Field> to_fields(vtkDataSetAttributes& attributes, std::size_t rows, const std::filesystem::path& place,
                             const std::function<Field(vtkDataArray&, const std::string&)>& convert);
// The check behind it.
void require_rows(vtkDataArray& array, const std::string& name, std::size_t rows, const std::filesystem::path& place);

// vtk_grid.cpp: the volume cells and the fields of a grid; `place` names it in messages, `format` is told in words. All
// linear kinds are taken; those of higher order are cut at their nodes if `subdivide` is 1, or count by their corners
// if it is 0 (ReadOptions::subdivide). Cells marked as duplicate or hidden in vtkGhostType, or with a point marked as
// hidden, are left out and counted. The grid is emptied on the way, so that little is held twice. Throws Error (format)
// for cells that do not fit their lists, Error (data) for other kinds and for point ids out of range.
Dataset to_dataset(vtkUnstructuredGrid& grid, const std::filesystem::path& place, const std::string& format,
                   int subdivide = 1);

// legacy_cells.cpp: VTK's legacy reader follows the vertex counts of the cells without a look at how long the list is,
// and crashes where they are wrong. Throws Error (format) for such a list.
void require_sound_legacy_cells(const std::filesystem::path& file);

}  // namespace cellproj
