// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: the families of formats that VTK reads, and what they share.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh/dataset.hpp"
#include "mesh/io/file_format.hpp"
#include "mesh/read.hpp"

class vtkAlgorithm;
class vtkDataObject;
class vtkDataSet;

namespace cellproj {

// read_vtk.cpp; read_without_vtk.cpp throws Error (environment) instead.
Dataset read_with_vtk(FileFormat format, const std::filesystem::path& file, const ReadOptions& options);

// One per family, all with the errors of `read`.
Dataset read_vtk_xml(const std::filesystem::path& file, const ReadOptions& options);
// Whether it only names the files that hold the data: a partitioned or multi-block file or a collection.
bool is_vtk_xml_index(const std::filesystem::path& file);
Dataset read_vtk_legacy(const std::filesystem::path& file, const ReadOptions& options);
Dataset read_openfoam(const std::filesystem::path& file, const ReadOptions& options);
Dataset read_ensight(const std::filesystem::path& file, const ReadOptions& options);
Dataset read_exodus(const std::filesystem::path& file, const ReadOptions& options);
// openfoam_files.cpp: throws Error (format) for a field at this time, in the case or one processor's part of it, whose file
// is cut off. `entry`: what the user named.
void require_whole_openfoam_fields(const std::filesystem::path& folder, double time, const std::filesystem::path& entry);
// netcdf_size.cpp: throws Error (format) for a classic netCDF file (Exodus II) that is shorter than its header says.
void require_whole_netcdf(const std::filesystem::path& file);
Dataset read_cgns(const std::filesystem::path& file, const ReadOptions& options);
Dataset read_fluent(const std::filesystem::path& file, const ReadOptions& options);
Dataset read_meta_image(const std::filesystem::path& file);
Dataset read_nrrd(const std::filesystem::path& file);
Dataset read_slc(const std::filesystem::path& file);

// ---- vtk_structured.cpp ----

// Whether `data` is a structured, rectilinear or image grid.
bool is_structured(vtkDataObject& data);

// A structured grid with its fields; as hexahedra where cells or points are blanked (vtkGhostType). Throws Error (data)
// for a grid of one point in a direction and Error (format) when its points are not as many as its dimensions say.
Dataset structured_to_dataset(vtkDataSet& grid, const std::filesystem::path& file, const std::string& format);

// ---- vtk_blocks.cpp ----

// The chosen volume blocks of whatever a reader gives: one dataset or a tree of them, named by their path in it
// ("fluid/internalMesh"). Throws Error as `to_dataset` and `require_known_blocks` do, and Error (data) when there is no
// volume block.
Dataset blocks_to_dataset(vtkDataObject& data, const std::filesystem::path& file, const std::string& format,
                          const ReadOptions& options);

// ---- vtk_amr.cpp ----

// VTK's AMR (.vth, .vthb), checked to be XML: all pieces of all levels. Throws as `assemble_pieces`.
Dataset read_vtk_amr(const std::filesystem::path& file, const std::string& format);

// ---- vtk_time.cpp ----

// The index of the time step nearest to `wanted`, the last one without a wish. `times` is not empty.
std::size_t nearest_time(const std::vector<double>& times, std::optional<double> wanted);

struct TimeSteps {
    std::vector<double> all;     // as the file lists them; empty when it has none
    std::optional<double> read;  // the chosen one
};

// Runs reader.UpdateInformation() and asks for the time step nearest to `wanted` in the next update. Throws as
// `update`.
TimeSteps choose_time(vtkAlgorithm& reader, const std::filesystem::path& file, std::optional<double> wanted);

// choose_time, update and blocks_to_dataset in one: for readers whose selections are made.
Dataset read_blocks(vtkAlgorithm& reader, const std::filesystem::path& file, const std::string& format,
                    const ReadOptions& options);

}  // namespace cellproj
