// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCellTypes.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/vtk_conversion.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// ---- What kind of file this is ----

constexpr std::size_t head_size = 4096;  // where both VTK formats have named their dataset

bool is_vtk_xml(std::string_view head) {
    return head.find("<VTKFile") != std::string_view::npos && head.substr(0, head.find('<')).size() <= 16;
}

bool is_vtk_legacy(std::string_view head) {
    return head.starts_with("# vtk DataFile");
}

// The value of the attribute `type` of the element <VTKFile …>; empty when it has none.
std::string xml_dataset_type(std::string_view head) {
    const std::string_view from = head.substr(head.find("<VTKFile"));
    std::string element(from.substr(0, from.find('>')));
    std::replace_if(
        element.begin(), element.end(), [](unsigned char c) { return std::isspace(c) != 0; }, ' ');
    const std::size_t name = element.find(" type=");  // the blank keeps header_type out
    if (name == std::string::npos || name + 6 >= element.size()) return "";
    const std::size_t value = name + 7;
    return element.substr(value, element.find(element[name + 6], value) - value);
}

// The word behind DATASET, in upper case; empty when there is none. Lines: version, title (any text), ASCII or BINARY.
std::string legacy_dataset_type(std::string_view head) {
    std::string upper(head.substr(std::min(head.find('\n'), head.size())));
    upper.erase(0, std::min(upper.find('\n', 1), upper.size()));
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
    const std::size_t keyword = upper.find("DATASET");
    if (keyword == std::string::npos) return "";
    const std::size_t word = std::min(upper.find_first_not_of(" \t", keyword + 7), upper.size());
    return upper.substr(word, upper.find_first_of(" \t\r\n", word) - word);
}

void require_unstructured(const std::string& found, const std::string& supported, const fs::path& file) {
    if (found == supported) return;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "the dataset type " + supported,
                 .found = found.empty() ? "a VTK file that names no dataset type" : "the type " + printable(found),
                 .advice = "unstructured grids (.vtu, legacy .vtk) and PLOT3D grids are supported: convert the file"});
}

// A reader of an appended block does not look beyond it, so a lost end would go unnoticed.
void require_xml_end(const fs::path& file) {
    const std::uint64_t size = fs::file_size(file);
    const std::string tail = read_bytes(file, size - std::min<std::uint64_t>(size, head_size), head_size);
    if (tail.find("</VTKFile>") != std::string::npos) return;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string() + ", byte " + std::to_string(size),
                 .expected = "</VTKFile>",
                 .found = "the end of the file",
                 .advice = "the file is cut off: write or copy it again"});
}

[[noreturn]] void throw_not_recognised(const fs::path& file, std::string_view head) {
    throw Error(
        {.kind = ErrorKind::format,
         .place = file.string(),
         .expected =
             "a VTK XML file (<VTKFile ...>), a legacy VTK file (# vtk DataFile ...) or a PLOT3D grid (.xyz, .x, "
             ".p3d, .g, .bin)",
         .found = "a file that starts with \"" + printable(std::string(head.substr(0, 24))) + "\"",
         .advice = "convert it to .vtu; for a PLOT3D grid of another suffix, give its solution file, too"});
}

// ---- Cells ----

std::optional<CellKind> supported_kind(int vtk_type) {
    switch (vtk_type) {
        case VTK_TETRA:
            return CellKind::tetrahedron;
        case VTK_HEXAHEDRON:
            return CellKind::hexahedron;
        default:
            return std::nullopt;
    }
}

std::size_t vertex_count(CellKind kind) {
    return kind == CellKind::tetrahedron ? 4 : 8;
}

// 0 to 3; none when VTK knows no such type.
std::optional<int> dimension(int vtk_type) {
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(vtk_type));
    return cell ? std::optional(cell->GetCellDimension()) : std::nullopt;
}

// "vtkQuadraticTetra" → "quadratic tetra"
std::string kind_name(int vtk_type) {
    std::string words;
    for (const char c : std::string_view(vtkCellTypes::GetClassNameFromTypeId(vtk_type)).substr(3)) {
        if (std::isupper(static_cast<unsigned char>(c)) != 0 && !words.empty()) words += ' ';
        words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return words;
}

using TypeCounts = std::map<int, std::size_t>;  // VTK cell type → number of cells

TypeCounts count_types(vtkUnsignedCharArray& types) {
    TypeCounts counts;
    for (vtkIdType c = 0; c < types.GetNumberOfValues(); ++c)
        ++counts[types.GetValue(c)];
    return counts;
}

std::string describe(const TypeCounts& counts) {
    std::string list;
    for (const auto& [type, count] : counts) {
        list += (list.empty() ? "" : ", ") + std::to_string(count) + " of kind \"" + kind_name(type) + "\"";
    }
    return list.empty() ? "no cells" : list;
}

// Throws Error (data) unless there are volume cells, all of them of supported kinds.
void require_supported_kinds(const TypeCounts& counts, const fs::path& file) {
    const auto fail = [&](ErrorKind kind, const std::string& found, const std::string& advice) {
        throw Error({.kind = kind,
                     .place = file.string(),
                     .expected = "tetrahedra and hexahedra",
                     .found = found,
                     .advice = advice});
    };
    TypeCounts unsupported;
    bool any_volume = false;
    for (const auto& [type, count] : counts) {
        const std::optional<int> dim = dimension(type);
        if (!dim) {
            fail(ErrorKind::format, "cells of the unknown VTK type " + std::to_string(type), "the file may be damaged");
        }
        if (*dim < 3) continue;
        any_volume = true;
        if (!supported_kind(type)) unsupported.insert({type, count});
    }
    if (!unsupported.empty()) {
        fail(ErrorKind::data, describe(unsupported),
             "cut these cells into tetrahedra, as with ParaView's filter Tetrahedralize");
    }
    if (!any_volume) {
        fail(ErrorKind::data, "no volume cells but " + describe(counts),
             "fill a closed surface with tetrahedra first: cellproj tetrahedralize");
    }
}

struct VolumeCells {
    CellList cells;
    std::vector<std::uint64_t> rows;  // #C: where each cell stands in the file, 0-based
};

[[noreturn]] void throw_bad_cell(const fs::path& file, std::size_t cell, const std::string& expected,
                                 const std::string& found, ErrorKind kind) {
    throw Error({.kind = kind,
                 .place = file.string() + ", cell " + std::to_string(cell),
                 .expected = expected,
                 .found = found,
                 .advice = "the file is damaged: write it again"});
}

// The cells of dimension 3 out of VTK's raw arrays. Nothing is followed before it has been checked.
template <class OffsetArray>
VolumeCells volume_cells(vtkUnsignedCharArray& types, OffsetArray& offsets, OffsetArray& connectivity,
                         const TypeCounts& counts, std::size_t point_count, const fs::path& file) {
    VolumeCells result;
    std::size_t cell_total = 0;
    std::size_t vertex_total = 0;
    for (const auto& [type, count] : counts) {
        if (const auto kind = supported_kind(type)) {
            cell_total += count;
            vertex_total += count * vertex_count(*kind);
        }
    }
    result.rows.reserve(cell_total);
    result.cells.kinds.reserve(cell_total);
    result.cells.offsets.reserve(cell_total + 1);
    result.cells.vertices.reserve(vertex_total);

    result.cells.offsets.push_back(0);
    for (vtkIdType c = 0; c < types.GetNumberOfValues(); ++c) {
        const std::optional<CellKind> kind = supported_kind(types.GetValue(c));
        if (!kind) continue;
        const auto row = static_cast<std::size_t>(c);
        const vtkIdType begin = offsets.GetValue(c);
        const vtkIdType end = offsets.GetValue(c + 1);
        const auto vertices = static_cast<vtkIdType>(vertex_count(*kind));
        if (begin < 0 || end < begin || end > connectivity.GetNumberOfValues() || end - begin != vertices) {
            throw_bad_cell(file, row, std::to_string(vertices) + " vertices",
                           "those from " + std::to_string(begin) + " to " + std::to_string(end) + " of a list of " +
                               std::to_string(connectivity.GetNumberOfValues()),
                           ErrorKind::format);
        }
        for (vtkIdType v = begin; v < end; ++v) {
            const vtkIdType id = connectivity.GetValue(v);
            if (id < 0 || static_cast<std::size_t>(id) >= point_count) {
                throw_bad_cell(file, row, "point ids from 0 to " + std::to_string(point_count - 1),
                               "the id " + std::to_string(id), ErrorKind::data);
            }
            result.cells.vertices.push_back(static_cast<VertexId>(id));
        }
        result.rows.push_back(row);
        result.cells.kinds.push_back(*kind);
        result.cells.offsets.push_back(result.cells.vertices.size());
    }
    return result;
}

VolumeCells read_cells(vtkUnstructuredGrid& grid, std::size_t point_count, const fs::path& file) {
    vtkUnsignedCharArray* types = grid.GetCellTypesArray();
    vtkCellArray* cells = grid.GetCells();
    const TypeCounts counts = types ? count_types(*types) : TypeCounts();
    require_supported_kinds(counts, file);
    if (!cells || cells->GetNumberOfCells() != types->GetNumberOfValues()) {
        throw Error({.kind = ErrorKind::format,
                     .place = file.string(),
                     .expected = "as many cells as cell types, " + std::to_string(types->GetNumberOfValues()),
                     .found = std::to_string(cells ? cells->GetNumberOfCells() : 0),
                     .advice = "the file is damaged: write it again"});
    }
    return cells->IsStorage64Bit() ? volume_cells(*types, *cells->GetOffsetsArray64(), *cells->GetConnectivityArray64(),
                                                  counts, point_count, file)
                                   : volume_cells(*types, *cells->GetOffsetsArray32(), *cells->GetConnectivityArray32(),
                                                  counts, point_count, file);
}

// ---- Unstructured grids ----

// The numeric arrays of `attributes`, converted by `convert(array, name)`; texts are left out.
template <class Convert>
std::vector<Field> read_fields(vtkDataSetAttributes& attributes, vtkIdType rows, const fs::path& file,
                               Convert convert) {
    std::vector<Field> fields;
    for (int i = 0; i < attributes.GetNumberOfArrays(); ++i) {
        vtkDataArray* array = attributes.GetArray(i);
        if (!array || array->GetNumberOfComponents() < 1) continue;
        const std::string name = array->GetName() ? array->GetName() : "unnamed " + std::to_string(i);
        if (array->GetNumberOfTuples() != rows) {
            throw Error({.kind = ErrorKind::format,
                         .place = file.string() + ", array \"" + name + "\"",
                         .expected = std::to_string(rows) + " rows",
                         .found = std::to_string(array->GetNumberOfTuples()),
                         .advice = "the file is damaged: write it again"});
        }
        fields.push_back(convert(*array, name));
    }
    return fields;
}

Dataset to_dataset(vtkUnstructuredGrid& grid, const fs::path& file, const char* format) {
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = format;
    if (grid.GetPoints()) dataset.points = to_points(*grid.GetPoints(), file);
    VolumeCells volume = read_cells(grid, dataset.points.size(), file);
    dataset.cells = std::move(volume.cells);
    dataset.skipped_cells = static_cast<std::size_t>(grid.GetNumberOfCells()) - dataset.cells.size();
    dataset.point_fields =
        read_fields(*grid.GetPointData(), grid.GetNumberOfPoints(), file,
                    [](vtkDataArray& array, const std::string& name) { return to_field(array, name); });
    dataset.cell_fields =
        read_fields(*grid.GetCellData(), grid.GetNumberOfCells(), file,
                    [&](vtkDataArray& array, const std::string& name) { return to_field(array, name, volume.rows); });
    return dataset;
}

Dataset read_vtk_xml(const fs::path& file, std::string_view head) {
    require_unstructured(xml_dataset_type(head), "UnstructuredGrid", file);
    require_xml_end(file);
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    reader->SetFileName(file.c_str());
    update(*reader, file);
    return to_dataset(*reader->GetOutput(), file, "VTK XML unstructured grid");
}

Dataset read_vtk_legacy(const fs::path& file, std::string_view head) {
    require_unstructured(legacy_dataset_type(head), "UNSTRUCTURED_GRID", file);
    require_sound_legacy_cells(file);
    vtkNew<vtkUnstructuredGridReader> reader;
    reader->SetFileName(file.c_str());
    // Without these, only the first array of each attribute is read.
    reader->ReadAllScalarsOn();
    reader->ReadAllVectorsOn();
    reader->ReadAllNormalsOn();
    reader->ReadAllTensorsOn();
    reader->ReadAllColorScalarsOn();
    reader->ReadAllTCoordsOn();
    reader->ReadAllFieldsOn();
    update(*reader, file);
    return to_dataset(*reader->GetOutput(), file, "VTK legacy unstructured grid");
}

}  // namespace

Dataset read(const fs::path& file, const ReadOptions& options) {
    require_readable(file);
    const std::string head = read_bytes(file, 0, head_size);
    const bool xml = is_vtk_xml(head);
    if (!xml && !is_vtk_legacy(head)) {
        if (options.solution.empty() && !has_plot3d_suffix(file)) throw_not_recognised(file, head);
        return read_plot3d(file, options.solution);
    }
    if (!options.solution.empty()) {
        throw Error({.kind = ErrorKind::option,
                     .place = "solution " + options.solution.string(),
                     .expected = "a PLOT3D grid it belongs to",
                     .found = file.string() + ", a VTK file, which holds its own fields",
                     .advice = "leave the solution out"});
    }
    return xml ? read_vtk_xml(file, head) : read_vtk_legacy(file, head);
}

}  // namespace cellproj
