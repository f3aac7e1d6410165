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
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"
#include "mesh/io/isolated_read.hpp"
#include "mesh/surface.hpp"
#include "mesh/io/surface_format.hpp"
#include "mesh/io/vtk_conversion.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t head_size = 4096;

SurfaceFormat require_format(const fs::path& file) {
    if (const auto format = detect_surface_format(file)) return *format;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a surface: STL, OFF, PLY, OBJ, VTP, or TetGen's .poly or .smesh",
                 .found = "a file that starts with \"" + printable(read_bytes(file, 0, 16)) + "\"",
                 .advice = "convert it; volume meshes need no tetrahedralize: render them directly"});
}

void require_whole_stl(const fs::path& file) {
    const std::uint64_t size = fs::file_size(file);
    const std::uint64_t announced = announced_stl_size(read_bytes(file, 0, head_size));
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

}  // namespace

Surface read_surface(const fs::path& file) {
    require_readable(file);
    const auto isolated = [&](const auto& work) {
        return read_isolated(file, fs::file_size(file), {}, [&] {
            use_one_thread();
            return work();
        });
    };
    switch (require_format(file)) {
        case SurfaceFormat::stl_ascii:
            require_stl_end(file);
            return isolated([&] { return read_stl(file); });
        case SurfaceFormat::stl_binary:
            require_whole_stl(file);
            return isolated([&] { return read_stl(file); });
        case SurfaceFormat::off:
            return read_off(file);
        case SurfaceFormat::ply:
            return read_ply(file);
        case SurfaceFormat::poly:
        case SurfaceFormat::smesh:
            return read_poly(file);
        case SurfaceFormat::obj:
            return isolated([&] {
                vtkNew<vtkOBJReader> reader;
                return read_with(*reader, file);
            });
        case SurfaceFormat::vtp:
            break;
    }
    return isolated([&] { return read_vtp(file); });
}

}  // namespace cellproj
