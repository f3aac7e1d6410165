// SPDX-License-Identifier: BSD-3-Clause
//
// Which format a file has: told by its content first, by its suffix where the content says nothing about itself.
#pragma once

#include <filesystem>
#include <optional>

namespace cellproj {

enum class FileFormat {
    vtk_xml,     // .vtu .vts .vtr .vti, partitioned .pvtu …, .vtm, .pvd
    vtk_legacy,  // .vtk
    plot3d,      // .xyz .x .p3d .g .bin; by suffix only
    openfoam,    // the folder of a case, its system/controlDict, or an (empty) file .foam in it
    ensight,     // EnSight Gold .case
    exodus,      // Exodus II .e .ex2 .exo (netCDF)
    cgns,        // .cgns (ADF or HDF5)
    meta_image,  // .mhd .mha
    nrrd,        // .nrrd .nhdr
    slc,         // VolVis .slc
    fluent,      // .msh .cas
    gmsh,        // .msh
    medit,       // .mesh
    su2,         // .su2
    tetgen,      // .node .ele; by suffix only
    hierarchy    // JSON that names the pieces of a hierarchy of grids
};

// In words, for messages: "EnSight Gold case".
const char* name(FileFormat format);

// None when neither content nor suffix is known. `file` must exist.
std::optional<FileFormat> detect_format(const std::filesystem::path& file);

}  // namespace cellproj
