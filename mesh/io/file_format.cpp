// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/file_format.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "mesh/io/file_bytes.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

bool contains(std::string_view text, std::string_view word) {
    return text.find(word) != std::string_view::npos;
}

// From the first line on that is neither blank nor a comment (#).
std::string_view without_comments(std::string_view head) {
    while (!head.empty()) {
        const std::size_t word = std::min(head.find_first_not_of(" \t\r\n"), head.size());
        head.remove_prefix(word);
        if (!head.starts_with('#')) break;
        head.remove_prefix(std::min(head.find('\n'), head.size()));
    }
    return head;
}

// HDF5 is the container of CGNS as well as of newer Exodus files; CGNS names its version in the root group.
std::optional<FileFormat> format_in_hdf5(const fs::path& file) {
    constexpr std::size_t root_group = 65536;
    if (contains(read_bytes(file, 0, root_group), "CGNSLibraryVersion")) return FileFormat::cgns;
    return lower_case(file.extension().string()) == ".cgns" ? FileFormat::cgns : FileFormat::exodus;
}

// SU2 starts with any of its keywords, most often the dimension, after comments (%).
bool is_su2(std::string_view head) {
    for (std::size_t line = 0; line < head.size(); line = head.find('\n', line) + 1) {
        std::string_view text = head.substr(line);
        text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
        if (text.starts_with("NDIME")) return true;
        if (head.find('\n', line) == std::string_view::npos) break;
    }
    return false;
}

// Fluent files are lists in brackets, each of which starts with the number of its kind: a comment (0), a header (1),
// the dimension (2) or nodes (10).
bool is_fluent(std::string_view text) {
    if (!text.starts_with('(')) return false;
    text.remove_prefix(1);
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
    const std::string_view number = text.substr(0, digits);
    const bool ends = digits < text.size() && std::isspace(static_cast<unsigned char>(text[digits])) != 0;
    return ends && (number == "0" || number == "1" || number == "2" || number == "10");
}

std::optional<FileFormat> format_by_content(const fs::path& file) {
    constexpr std::size_t head_size = 4096;
    const std::string bytes = read_bytes(file, 0, head_size);
    const std::string_view head(bytes);
    const std::string_view text = without_comments(head);
    if (contains(head, "<VTKFile") && head.find('<') <= 16) return FileFormat::vtk_xml;
    if (head.starts_with("# vtk DataFile")) return FileFormat::vtk_legacy;
    if (head.starts_with("CDF")) return FileFormat::exodus;
    if (head.starts_with("\x89HDF\r\n")) return format_in_hdf5(file);
    if (contains(head.substr(0, 64), "ADF Database Version")) return FileFormat::cgns;
    if (head.starts_with("NRRD000")) return FileFormat::nrrd;
    if (head.starts_with("11111\n") || head.starts_with("11111 ")) return FileFormat::slc;  // its magic number
    if (is_fluent(text)) return FileFormat::fluent;
    if (head.starts_with("$MeshFormat")) return FileFormat::gmsh;
    if (text.starts_with("MeshVersionFormatted")) return FileFormat::medit;
    if (text.starts_with("FORMAT") && contains(lower_case(std::string(text.substr(0, 256))), "ensight")) {
        return FileFormat::ensight;
    }
    if (contains(head, "NDims") && contains(head, "ElementType")) return FileFormat::meta_image;
    if (contains(head, "FoamFile") && file.filename() == "controlDict") return FileFormat::openfoam;
    if (text.starts_with('{') && contains(head, "\"pieces\"")) return FileFormat::hierarchy;
    if (is_su2(head)) return FileFormat::su2;
    return std::nullopt;
}

struct Suffix {
    const char* suffix;
    FileFormat format;
};

// Of the formats that do not tell themselves, or not always.
constexpr std::array<Suffix, 11> suffixes{{{".xyz", FileFormat::plot3d},
                                           {".x", FileFormat::plot3d},
                                           {".p3d", FileFormat::plot3d},
                                           {".g", FileFormat::plot3d},
                                           {".bin", FileFormat::plot3d},
                                           {".node", FileFormat::tetgen},
                                           {".ele", FileFormat::tetgen},
                                           {".foam", FileFormat::openfoam},
                                           {".openfoam", FileFormat::openfoam},
                                           {".case", FileFormat::ensight},
                                           {".encas", FileFormat::ensight}}};

std::optional<FileFormat> format_by_suffix(const fs::path& file) {
    const std::string suffix = lower_case(file.extension().string());
    const auto* found =
        std::find_if(suffixes.begin(), suffixes.end(), [&](const Suffix& known) { return suffix == known.suffix; });
    return found == suffixes.end() ? std::nullopt : std::optional(found->format);
}

bool is_openfoam_case(const fs::path& folder) {
    return fs::exists(folder / "system" / "controlDict") || fs::exists(folder / "constant" / "polyMesh");
}

}  // namespace

const char* name(FileFormat format) {
    switch (format) {
        case FileFormat::vtk_xml:
            return "VTK XML";
        case FileFormat::vtk_legacy:
            return "VTK legacy";
        case FileFormat::plot3d:
            return "PLOT3D";
        case FileFormat::openfoam:
            return "OpenFOAM case";
        case FileFormat::ensight:
            return "EnSight Gold case";
        case FileFormat::exodus:
            return "Exodus II";
        case FileFormat::cgns:
            return "CGNS";
        case FileFormat::meta_image:
            return "MetaImage";
        case FileFormat::nrrd:
            return "NRRD";
        case FileFormat::slc:
            return "SLC";
        case FileFormat::fluent:
            return "Fluent";
        case FileFormat::gmsh:
            return "Gmsh";
        case FileFormat::medit:
            return "Medit";
        case FileFormat::su2:
            return "SU2";
        case FileFormat::tetgen:
            return "TetGen";
        case FileFormat::hierarchy:
            return "hierarchy of grids";
    }
    return "unknown";
}

std::optional<FileFormat> detect_format(const fs::path& file) {
    if (fs::is_directory(file)) return is_openfoam_case(file) ? std::optional(FileFormat::openfoam) : std::nullopt;
    const std::optional<FileFormat> by_content = format_by_content(file);
    return by_content ? by_content : format_by_suffix(file);
}

}  // namespace cellproj
