// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/read.hpp"

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"
#include "mesh/io/file_format.hpp"
#include "mesh/text_formats.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// What to do with a file of a known suffix that cannot be read.
std::string advice_for(const fs::path& file) {
    const std::string suffix = file.extension().string();
    if (suffix == ".raw" || suffix == ".dat") {
        return "bare voxels need their layout: --dims NX NY NZ --type uint8 (or int16, float32, ...)";
    }
    if (suffix == ".frd" || suffix == ".inp")
        return "CalculiX results: convert them to .vtu, as with ccx2paraview FILE vtu";
    if (suffix == ".face" || suffix == ".poly" || suffix == ".smesh") {
        return "these are faces; give the tetrahedra, the .ele file, or fill the surface: cellproj tetrahedralize";
    }
    return "convert it to .vtu; for a PLOT3D grid of another suffix, give its solution file, too";
}

[[noreturn]] void throw_not_recognised(const fs::path& file) {
    const std::string head = fs::is_directory(file) ? "" : read_bytes(file, 0, 24);
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected =
                     "VTK XML (<VTKFile ...>) or legacy VTK (# vtk DataFile ...), an OpenFOAM case (.foam or its "
                     "folder), EnSight Gold (.case), Exodus II, CGNS, Fluent (.cas, .msh), MetaImage, NRRD, SLC, Gmsh, "
                     "Medit, SU2, TetGen (.node, .ele), JSON that names the pieces of a hierarchy of grids, or a PLOT3D grid (.xyz, .x, .p3d, .g, .bin)",
                 .found = head.empty() ? "a folder that is no OpenFOAM case"
                                       : "a file that starts with \"" + printable(head) + "\"",
                 .advice = advice_for(file)});
}

FileFormat require_format(const fs::path& file, const ReadOptions& options) {
    const std::optional<FileFormat> format = fs::exists(file) ? detect_format(file) : std::nullopt;
    // The file .foam is empty as a rule, and the case may be named by its folder.
    if (format == FileFormat::openfoam) return *format;
    require_readable(file);
    if (format) return *format;
    if (options.solution.empty()) throw_not_recognised(file);
    return FileFormat::plot3d;
}

void require_no_solution(const fs::path& file, FileFormat format, const ReadOptions& options) {
    if (format == FileFormat::plot3d || options.solution.empty()) return;
    throw Error({.kind = ErrorKind::option,
                 .place = "solution " + options.solution.string(),
                 .expected = "a PLOT3D grid it belongs to",
                 .found = file.string() + ", of the format " + name(format) + ", which holds its own fields",
                 .advice = "leave the solution out"});
}

Dataset read_format(FileFormat format, const fs::path& file, const ReadOptions& options) {
    switch (format) {
        case FileFormat::plot3d:
            return read_plot3d(file, options.solution, options.blocks);
        case FileFormat::gmsh:
            return read_gmsh(file, options.subdivide);
        case FileFormat::medit:
            return read_medit(file);
        case FileFormat::su2:
            return read_su2(file);
        case FileFormat::tetgen:
            return read_tetgen(file, options.subdivide);
        case FileFormat::hierarchy:
            return read_hierarchy(file, options);
        default:
            return read_with_vtk(format, file, options);
    }
}

// A wish that the file cannot fulfil is no wish to pass over.
void require_used(const Dataset& dataset, const fs::path& file, const ReadOptions& options) {
    const auto fail = [&](const std::string& option, const std::string& expected, const std::string& found) {
        throw Error({.kind = ErrorKind::option,
                     .place = file.string() + ", " + option,
                     .expected = expected,
                     .found = found,
                     .advice = "leave the choice out"});
    };
    if (!options.blocks.empty() && dataset.blocks.empty()) {
        fail("block " + options.blocks.front(), "a file of several blocks", "one without block names");
    }
    if (options.time && dataset.times.empty()) {
        fail("time " + std::to_string(*options.time), "a file with time steps", "one without");
    }
}

}  // namespace

Dataset read(const fs::path& file, const ReadOptions& options) {
    if (options.raw) {
        Dataset dataset = read_raw(file, *options.raw);
        require_used(dataset, file, options);
        return dataset;
    }
    const FileFormat format = require_format(file, options);
    require_no_solution(file, format, options);
    Dataset dataset = read_format(format, file, options);
    require_used(dataset, file, options);
    return dataset;
}

}  // namespace cellproj
