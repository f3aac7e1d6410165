// SPDX-License-Identifier: BSD-3-Clause
#include <system_error>

#include "mesh/error.hpp"
#include "mesh/io/isolated_read.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

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
        case FileFormat::hierarchy:
            break;  // text_formats.hpp
    }
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a format that VTK reads",
                 .found = name(format),
                 .advice = "use the reader of that format"});
}

// Formats whose file names others beside or below it.
bool names_other_files(FileFormat format, const std::filesystem::path& file) {
    switch (format) {
        case FileFormat::vtk_xml:
            return is_vtk_xml_index(file);
        case FileFormat::openfoam:
        case FileFormat::ensight:
        case FileFormat::cgns:
        case FileFormat::fluent:
        case FileFormat::meta_image:
        case FileFormat::nrrd:
            return true;
        default:
            return false;
    }
}

// Of all files in a folder and below it, any of which may be part of what is read. Ends somewhere in very large folders.
std::uintmax_t folder_bytes(const std::filesystem::path& folder) {
    constexpr int most_entries = 20000;
    std::uintmax_t bytes = 0;
    int entries = 0;
    std::error_code error;
    using Iterator = std::filesystem::recursive_directory_iterator;
    const auto options = std::filesystem::directory_options::skip_permission_denied;
    for (Iterator entry(folder, options, error); !error && entry != Iterator() && entries < most_entries;
         entry.increment(error), ++entries) {
        std::error_code no_size;
        if (entry->is_regular_file(no_size)) bytes += entry->file_size(no_size);
    }
    return bytes;
}

std::uintmax_t bytes_to_read(FileFormat format, const std::filesystem::path& file) {
    if (std::filesystem::is_directory(file)) return folder_bytes(file);
    if (names_other_files(format, file)) return folder_bytes(std::filesystem::absolute(file).parent_path());
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(file, error);
    return error ? 0 : bytes;
}

}  // namespace

Dataset read_with_vtk(FileFormat format, const std::filesystem::path& file, const ReadOptions& options) {
    return read_isolated(file, bytes_to_read(format, file), options.progress, [&] {
        use_one_thread();
        return read_family(format, file, options);
    });
}

}  // namespace cellproj
