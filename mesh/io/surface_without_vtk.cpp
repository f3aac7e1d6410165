// SPDX-License-Identifier: BSD-3-Clause
//
// Stands in for read_surface.cpp and write_vtu.cpp where VTK is switched off: OFF, PLY and TetGen's files are read, the rest
// says how to get it.
#include <string>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"
#include "mesh/surface.hpp"
#include "mesh/io/surface_format.hpp"
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
    require_readable(file);
    switch (detect_surface_format(file).value_or(SurfaceFormat::vtp)) {
        case SurfaceFormat::off:
            return read_off(file);
        case SurfaceFormat::ply:
            return read_ply(file);
        case SurfaceFormat::poly:
        case SurfaceFormat::smesh:
            return read_poly(file);
        default:
            fail(file, "reads surfaces other than OFF, PLY, .poly and .smesh files");
    }
}

void write_vtu(const TetMesh&, const std::filesystem::path& file) {
    fail(file, "writes .vtu files");
}

void write_vtp(const Surface&, const std::vector<Field>&, const std::filesystem::path& file) {
    fail(file, "writes .vtp files");
}

}  // namespace cellproj
