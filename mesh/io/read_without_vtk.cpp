// SPDX-License-Identifier: BSD-3-Clause
//
// Stands in for the readers that need VTK where it is switched off.
#include "mesh/error.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

Dataset read_with_vtk(FileFormat format, const std::filesystem::path& file, const ReadOptions&) {
    throw Error({.kind = ErrorKind::environment,
                 .place = file.string(),
                 .expected = std::string("a cellproj built with VTK, whose readers read the format ") + name(format),
                 .found = "one built without, which reads TetGen, Gmsh, Medit, SU2, PLOT3D and raw files only",
                 .advice = "install VTK 9 (Debian: libvtk9-dev) and build with -DCELLPROJ_WITH_VTK=ON"});
}

}  // namespace cellproj
