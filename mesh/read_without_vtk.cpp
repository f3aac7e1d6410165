// SPDX-License-Identifier: BSD-3-Clause
//
// Stands in for read_vtk.cpp and read_plot3d.cpp where VTK is switched off.
#include "mesh/error.hpp"
#include "mesh/read.hpp"

namespace cellproj {

Dataset read(const std::filesystem::path& file, const ReadOptions&) {
    throw Error({.kind = ErrorKind::environment,
                 .place = file.string(),
                 .expected = "a cellproj built with VTK, whose readers read mesh files",
                 .found = "one built without",
                 .advice = "install VTK 9 (Debian: libvtk9-dev) and build with -DCELLPROJ_WITH_VTK=ON"});
}

}  // namespace cellproj
