// SPDX-License-Identifier: BSD-3-Clause
//
// Stands in for read_surface.cpp and write_vtu.cpp where VTK is switched off: OFF and PLY are read, the rest says how
// to get it.
#include <string>

#include "mesh/error.hpp"
#include "mesh/surface.hpp"
#include "mesh/write_vtu.hpp"

namespace cellproj {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
    throw Error({.kind = ErrorKind::environment,
                 .place = file.string(),
                 .expected = "a cellproj built with VTK, which " + what,
                 .found = "one built without",
                 .advice = "install VTK 9 (Debian: libvtk9-dev) and build with -DCELLPROJ_WITH_VTK=ON"});
}

}  // namespace

Surface read_surface(const std::filesystem::path& file) {
    if (file.extension() == ".off") return read_off(file);
    if (file.extension() == ".ply") return read_ply(file);
    fail(file, "reads surfaces other than .off and .ply files");
}

void write_vtu(const TetMesh&, const std::filesystem::path& file) {
    fail(file, "writes .vtu files");
}

}  // namespace cellproj
