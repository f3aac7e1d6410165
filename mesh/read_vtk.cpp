// SPDX-License-Identifier: BSD-3-Clause
#include <system_error>

#include "mesh/error.hpp"
#include "mesh/trial_read.hpp"
#include "mesh/vtk_conversion.hpp"
#include "mesh/vtk_readers.hpp"

namespace cellproj {

namespace {

Dataset read_family(FileFormat format, const std::filesystem::path& file, const ReadOptions& options) {
    switch (format) {
        case FileFormat::vtk_xml:
            return read_vtk_xml(file, options);
        case FileFormat::vtk_legacy:
            return read_vtk_legacy(file, options);
        case FileFormat::openfoam:
            return read_openfoam(file, options);
        case FileFormat::ensight:
            return read_ensight(file, options);
        case FileFormat::exodus:
            return read_exodus(file, options);
        case FileFormat::cgns:
            return read_cgns(file, options);
        case FileFormat::meta_image:
            return read_meta_image(file);
        case FileFormat::nrrd:
            return read_nrrd(file);
        case FileFormat::slc:
            return read_slc(file);
        case FileFormat::fluent:
            return read_fluent(file, options);
        case FileFormat::plot3d:
        case FileFormat::gmsh:
        case FileFormat::medit:
        case FileFormat::su2:
        case FileFormat::tetgen:
            break;  // text_formats.hpp
    }
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a format that VTK reads",
                 .found = name(format),
                 .advice = "use the reader of that format"});
}

// These crash, hang, end the process or print to the terminal when a file is cut off.
bool is_fragile(FileFormat format) {
    return format == FileFormat::ensight || format == FileFormat::cgns || format == FileFormat::meta_image ||
           format == FileFormat::nrrd || format == FileFormat::exodus || format == FileFormat::slc ||
           format == FileFormat::fluent;
}

// Of a file and of all others in its folder, which may be its parts.
std::uintmax_t folder_bytes(const std::filesystem::path& file) {
    std::uintmax_t bytes = 0;
    std::error_code error;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::absolute(file).parent_path(), error)) {
        if (entry.is_regular_file(error)) bytes += entry.file_size(error);
    }
    return bytes;
}

}  // namespace

Dataset read_with_vtk(FileFormat format, const std::filesystem::path& file, const ReadOptions& options) {
    if (is_fragile(format)) {
        require_harmless(file, folder_bytes(file), [&] { read_family(format, file, options); });
    }
    return read_family(format, file, options);
}

}  // namespace cellproj
