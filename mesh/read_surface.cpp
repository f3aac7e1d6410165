// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/file_bytes.hpp"
#include "mesh/isolated_read.hpp"
#include "mesh/surface.hpp"
#include "mesh/vtk_conversion.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t head_size = 4096;
constexpr std::uint64_t stl_header = 84, stl_facet = 50;  // bytes of a binary STL

enum class Format { stl_ascii, stl_binary, off, ply, obj, vtp };

std::string lower_suffix(const fs::path& file) {
    std::string suffix = file.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
    return suffix;
}

// The first line that is neither empty nor a comment.
std::string_view first_line(std::string_view head) {
    while (!head.empty()) {
        std::string_view line = head.substr(0, head.find('\n'));
        head.remove_prefix(std::min(line.size() + 1, head.size()));
        line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
        if (!line.empty() && line.front() != '#') return line;
    }
    return {};
}

std::uint64_t announced_stl_size(std::string_view head) {
    std::uint32_t facets = 0;
    if (head.size() < stl_header) return 0;
    std::memcpy(&facets, head.data() + stl_header - sizeof(facets), sizeof(facets));
    return stl_header + stl_facet * facets;
}

Format format_of(const fs::path& file) {
    const std::string head = read_bytes(file, 0, head_size);
    const std::string_view line = first_line(head);
    const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
    // Many programs begin the free text of a binary STL with "solid", too: the size tells.
    if (announced_stl_size(head) == fs::file_size(file)) return Format::stl_binary;
    if (head.starts_with("ply")) return Format::ply;
    if (head.find("<VTKFile") != std::string::npos) return Format::vtp;
    if (word.ends_with("OFF")) return Format::off;
    if (word == "solid") return Format::stl_ascii;
    const std::string suffix = lower_suffix(file);
    if (suffix == ".stl") return Format::stl_binary;
    if (suffix == ".obj") return Format::obj;
    if (suffix == ".off") return Format::off;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a surface: STL, OFF, PLY, OBJ or VTP",
                 .found = "a file that starts with \"" + printable(head.substr(0, 16)) + "\"",
                 .advice = "convert it; volume meshes need no tetrahedralize: render them directly"});
}

void require_whole_stl(const fs::path& file) {
    const std::uint64_t size = fs::file_size(file);
    const std::uint64_t announced = announced_stl_size(read_bytes(file, 0, stl_header));
    if (size == announced) return;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = announced == 0 ? "a binary STL file of at least 84 bytes"
                                            : "the " + std::to_string(announced) + " bytes its header announces",
                 .found = std::to_string(size),
                 .advice = "the file is cut off or damaged: write or copy it again"});
}

// A file of lines that VTK reads to its end without asking whether that was the end.
void require_stl_end(const fs::path& file) {
    const std::uint64_t size = fs::file_size(file);
    const std::string tail = read_bytes(file, size - std::min<std::uint64_t>(size, head_size), head_size);
    if (tail.find("endsolid") != std::string::npos) return;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "the word endsolid near the end",
                 .found = "none",
                 .advice = "the file is cut off or damaged: write or copy it again"});
}

void append_cell(Surface& surface, int type, const vtkIdType* vertices, vtkIdType count) {
    const auto id = [&](vtkIdType i) { return static_cast<VertexId>(vertices[i]); };
    if (type == VTK_TRIANGLE_STRIP) {
        for (vtkIdType i = 2; i < count; ++i)
            surface.polygons.push_back({id(i - 2), id(i - 1), id(i)});
    } else if (type == VTK_TRIANGLE || type == VTK_QUAD || type == VTK_POLYGON) {
        std::vector<VertexId>& polygon = surface.polygons.emplace_back();
        for (vtkIdType i = 0; i < count; ++i)
            polygon.push_back(id(i));
    }
}

Surface to_surface(vtkPolyData& data, const fs::path& file) {
    Surface surface;
    surface.name = file.string();
    if (vtkPoints* points = data.GetPoints()) surface.points = to_points(*points, file);
    data.BuildCells();
    for (vtkIdType cell = 0; cell < data.GetNumberOfCells(); ++cell) {
        vtkIdType count = 0;
        const vtkIdType* vertices = nullptr;
        data.GetCellPoints(cell, count, vertices);
        append_cell(surface, data.GetCellType(cell), vertices, count);
    }
    validate(surface);
    return surface;
}

template <class Reader>
Surface read_with(Reader& reader, const fs::path& file) {
    reader.SetFileName(file.c_str());
    update(reader, file);
    return to_surface(*reader.GetOutput(), file);
}

// Facets as the file has them: VTK's own merging of points would drop some and so change their numbers.
Surface read_stl(const fs::path& file) {
    vtkNew<vtkSTLReader> reader;
    reader->MergingOff();
    return read_with(*reader, file);
}

Surface read_vtp(const fs::path& file) {
    vtkNew<vtkXMLPolyDataReader> reader;
    Surface surface = read_with(*reader, file);
    vtkPointData& data = *reader->GetOutput()->GetPointData();
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
        if (vtkDataArray* array = data.GetArray(i)) {
            surface.point_fields.push_back(to_field(*array, array->GetName() ? array->GetName() : "unnamed"));
        }
    }
    validate(surface);
    return surface;
}

Surface read_with_vtk(Format format, const fs::path& file) {
    use_one_thread();
    if (format == Format::vtp) return read_vtp(file);
    if (format != Format::obj) return read_stl(file);
    vtkNew<vtkOBJReader> reader;
    return read_with(*reader, file);
}

}  // namespace

Surface read_surface(const fs::path& file) {
    require_readable(file);
    const Format format = format_of(file);
    if (format == Format::off) return read_off(file);
    if (format == Format::ply) return read_ply(file);
    if (format == Format::stl_ascii) require_stl_end(file);
    if (format == Format::stl_binary) require_whole_stl(file);
    return read_isolated(file, fs::file_size(file), {}, [&] { return read_with_vtk(format, file); });
}

}  // namespace cellproj
