// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCellTypes.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <cctype>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "mesh/cell_faces.hpp"
#include "mesh/error.hpp"
#include "mesh/vtk_conversion.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// ---- Cells ----

// How a VTK type becomes one of ours. Cells of higher order list their corners first, in the order of the linear kind.
struct KindRule {
    CellKind kind;
    bool corners_only = false;  // more vertices may follow; they are left out
};

std::optional<KindRule> rule_for(int vtk_type) {
    switch (vtk_type) {
        case VTK_TETRA:
            return KindRule{CellKind::tetrahedron};
        case VTK_VOXEL:
        case VTK_HEXAHEDRON:
            return KindRule{CellKind::hexahedron};
        case VTK_WEDGE:
            return KindRule{CellKind::wedge};
        case VTK_PYRAMID:
            return KindRule{CellKind::pyramid};
        case VTK_PENTAGONAL_PRISM:
            return KindRule{CellKind::pentagonal_prism};
        case VTK_HEXAGONAL_PRISM:
            return KindRule{CellKind::hexagonal_prism};
        case VTK_POLYHEDRON:
            return KindRule{CellKind::polyhedron};
        case VTK_QUADRATIC_TETRA:
        case VTK_LAGRANGE_TETRAHEDRON:
        case VTK_BEZIER_TETRAHEDRON:
            return KindRule{CellKind::tetrahedron, true};
        case VTK_QUADRATIC_HEXAHEDRON:
        case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
        case VTK_TRIQUADRATIC_HEXAHEDRON:
        case VTK_LAGRANGE_HEXAHEDRON:
        case VTK_BEZIER_HEXAHEDRON:
            return KindRule{CellKind::hexahedron, true};
        case VTK_QUADRATIC_WEDGE:
        case VTK_QUADRATIC_LINEAR_WEDGE:
        case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
        case VTK_LAGRANGE_WEDGE:
        case VTK_BEZIER_WEDGE:
            return KindRule{CellKind::wedge, true};
        case VTK_QUADRATIC_PYRAMID:
        case VTK_TRIQUADRATIC_PYRAMID:
        case VTK_LAGRANGE_PYRAMID:
        case VTK_BEZIER_PYRAMID:
            return KindRule{CellKind::pyramid, true};
        default:
            return std::nullopt;
    }
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
void require_supported_kinds(const TypeCounts& counts, const fs::path& place) {
    const auto fail = [&](ErrorKind kind, const std::string& found, const std::string& advice) {
        throw Error({.kind = kind,
                     .place = place.string(),
                     .expected =
                         "cells that can be cut into tetrahedra: tetrahedra, hexahedra, voxels, wedges, pyramids, "
                         "pentagonal and hexagonal prisms, polyhedra",
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
        if (!rule_for(type)) unsupported.insert({type, count});
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

void require_rows(vtkDataArray& array, const std::string& name, vtkIdType rows, const fs::path& place) {
    if (array.GetNumberOfTuples() == rows) return;
    throw Error({.kind = ErrorKind::format,
                 .place = place.string() + ", array \"" + name + "\"",
                 .expected = std::to_string(rows) + " rows",
                 .found = std::to_string(array.GetNumberOfTuples()),
                 .advice = "the file is damaged: write it again"});
}

struct VolumeCells {
    CellList cells;
    std::vector<std::uint64_t> rows;  // #C: where each cell stands in the file, 0-based; empty when all cells are taken
    std::size_t ghosts = 0;           // volume cells left out
};

// VTK's marks for cells and points that are not to be drawn, one number per row, bits of vtkDataSetAttributes.
class GhostMarks {
public:
    // Throws Error (format) when there are marks, but not one for each of `rows` rows.
    GhostMarks(vtkDataSetAttributes& attributes, vtkIdType rows, const fs::path& place)
        : marks_(attributes.GetArray(vtkDataSetAttributes::GhostArrayName())) {
        if (marks_) require_rows(*marks_, vtkDataSetAttributes::GhostArrayName(), rows, place);
    }

    bool has(vtkIdType row, int bits) const {
        return marks_ && (static_cast<int>(marks_->GetComponent(row, 0)) & bits) != 0;
    }

private:
    vtkDataArray* marks_;
};

// The cells of dimension 3 out of VTK's raw arrays. Nothing is followed before it has been checked.
class VolumeCellReader {
public:
    // `points`: the number of them, which may be gone from the grid.
    VolumeCellReader(vtkUnstructuredGrid& grid, vtkIdType points, const fs::path& place)
        : types_(*grid.GetCellTypesArray()),
          cells_(*grid.GetCells()),
          faces_(grid.GetFaces()),
          face_locations_(grid.GetFaceLocations()),
          points_(points),
          cell_marks_(*grid.GetCellData(), grid.GetNumberOfCells(), place),
          point_marks_(*grid.GetPointData(), points_, place),
          place_(place) {}

    VolumeCells read() {
        VolumeCells result;
        std::vector<VertexId>& list = result.cells.vertices;
        // At most so many but for polyhedra; growing by doubling would hold up to three times as much.
        result.cells.kinds.reserve(static_cast<std::size_t>(types_.GetNumberOfValues()));
        list.reserve(static_cast<std::size_t>(cells_.GetNumberOfConnectivityIds()));
        for (cell_ = 0; cell_ < types_.GetNumberOfValues(); ++cell_) {
            const std::size_t begin = list.size();
            const int type = types_.GetValue(cell_);
            const std::optional<KindRule> rule = rule_for(type);
            if (!rule) continue;
            hidden_ = cell_marks_.has(cell_, vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL);
            if (rule->kind == CellKind::polyhedron) {
                append_face_stream(list);
            } else {
                append_vertices(*rule, list);
                // A voxel counts through x, then y; a hexahedron goes around.
                if (type == VTK_VOXEL) {
                    std::swap(list.end()[-6], list.end()[-5]);
                    std::swap(list.end()[-2], list.end()[-1]);
                }
            }
            if (hidden_) {
                list.resize(begin);
                ++result.ghosts;
                continue;
            }
            // Rows are kept from the first one on that was passed over.
            const std::size_t taken = result.cells.size();
            if (taken != static_cast<std::size_t>(cell_) && result.rows.empty()) {
                result.rows.resize(taken);
                std::iota(result.rows.begin(), result.rows.end(), std::uint64_t{0});
            }
            if (taken != static_cast<std::size_t>(cell_)) result.rows.push_back(static_cast<std::uint64_t>(cell_));
            result.cells.kinds.push_back(rule->kind);
        }
        return result;
    }

private:
    [[noreturn]] void fail(ErrorKind kind, const std::string& expected, const std::string& found) const {
        throw Error({.kind = kind,
                     .place = place_.string() + ", cell " + std::to_string(cell_),
                     .expected = expected,
                     .found = found,
                     .advice = "the file is damaged: write it again"});
    }

    void append_point(vtkIdType id, std::vector<VertexId>& list) {
        if (id < 0 || id >= points_) {
            fail(ErrorKind::data, "point ids from 0 to " + std::to_string(points_ - 1), "the id " + std::to_string(id));
        }
        hidden_ = hidden_ || point_marks_.has(id, vtkDataSetAttributes::HIDDENPOINT);
        list.push_back(static_cast<VertexId>(id));
    }

    void append_vertices(const KindRule& rule, std::vector<VertexId>& list) {
        if (cells_.IsStorage64Bit()) {
            append_vertices(rule, *cells_.GetOffsetsArray64(), *cells_.GetConnectivityArray64(), list);
        } else {
            append_vertices(rule, *cells_.GetOffsetsArray32(), *cells_.GetConnectivityArray32(), list);
        }
    }

    template <class Array>
    void append_vertices(const KindRule& rule, Array& offsets, Array& connectivity, std::vector<VertexId>& list) {
        const vtkIdType begin = offsets.GetValue(cell_);
        const vtkIdType end = offsets.GetValue(cell_ + 1);
        const auto corners = static_cast<vtkIdType>(vertex_count(rule.kind));
        const bool fits = rule.corners_only ? end - begin >= corners : end - begin == corners;
        if (begin < 0 || end < begin || end > connectivity.GetNumberOfValues() || !fits) {
            fail(ErrorKind::format, std::to_string(corners) + " vertices",
                 "those from " + std::to_string(begin) + " to " + std::to_string(end) + " of a list of " +
                     std::to_string(connectivity.GetNumberOfValues()));
        }
        for (vtkIdType v = begin; v < begin + corners; ++v)
            append_point(connectivity.GetValue(v), list);
    }

    // The entry of VTK's face streams, or the Error (format) that it is not there.
    vtkIdType face_entry(vtkIdType at) const {
        if (at >= 0 && faces_ && at < faces_->GetNumberOfValues()) return faces_->GetValue(at);
        fail(ErrorKind::format, "the faces of a polyhedron",
             "the place " + std::to_string(at) + " in a list of " +
                 std::to_string(faces_ ? faces_->GetNumberOfValues() : 0));
    }

    void append_count(vtkIdType count, vtkIdType least, const char* what, std::vector<VertexId>& list) const {
        if (count < least || count > faces_->GetNumberOfValues()) {
            fail(ErrorKind::format, "a polyhedron with at least " + std::to_string(least) + " " + what,
                 std::to_string(count));
        }
        list.push_back(static_cast<VertexId>(count));
    }

    void append_face_stream(std::vector<VertexId>& list) {
        const bool located = face_locations_ && cell_ < face_locations_->GetNumberOfValues();
        vtkIdType at = located ? face_locations_->GetValue(cell_) : -1;
        const vtkIdType faces = face_entry(at);
        append_count(faces, 4, "faces", list);
        for (vtkIdType face = 0; face < faces; ++face) {
            const vtkIdType vertices = face_entry(++at);
            append_count(vertices, 3, "vertices in each face", list);
            for (vtkIdType v = 0; v < vertices; ++v)
                append_point(face_entry(++at), list);
        }
    }

    vtkUnsignedCharArray& types_;
    vtkCellArray& cells_;
    vtkIdTypeArray* faces_;           // null without polyhedra
    vtkIdTypeArray* face_locations_;  // where each cell's faces begin
    vtkIdType points_;
    GhostMarks cell_marks_;
    GhostMarks point_marks_;
    const fs::path& place_;

    vtkIdType cell_ = 0;   // the one at hand
    bool hidden_ = false;  // whether it is
};

// How many entries of the list the cell that starts there has.
std::size_t entries_of(CellKind kind, const VertexId* first) {
    if (kind != CellKind::polyhedron) return vertex_count(kind);
    std::size_t entries = 1;
    for (VertexId face = 0; face < *first; ++face)
        entries += 1 + first[entries];
    return entries;
}

// Made when VTK's own lists are gone: 8 bytes per cell.
void add_offsets(CellList& cells) {
    cells.offsets.reserve(cells.size() + 1);
    cells.offsets.push_back(0);
    for (const CellKind kind : cells.kinds) {
        const std::uint64_t begin = cells.offsets.back();
        cells.offsets.push_back(begin + entries_of(kind, cells.vertices.data() + begin));
    }
}

VolumeCells read_cells(vtkUnstructuredGrid& grid, vtkIdType points, const fs::path& place) {
    vtkUnsignedCharArray* types = grid.GetCellTypesArray();
    vtkCellArray* cells = grid.GetCells();
    require_supported_kinds(types ? count_types(*types) : TypeCounts(), place);
    if (!cells || cells->GetNumberOfCells() != types->GetNumberOfValues()) {
        throw Error({.kind = ErrorKind::format,
                     .place = place.string(),
                     .expected = "as many cells as cell types, " + std::to_string(types->GetNumberOfValues()),
                     .found = std::to_string(cells ? cells->GetNumberOfCells() : 0),
                     .advice = "the file is damaged: write it again"});
    }
    return VolumeCellReader(grid, points, place).read();
}

// ---- Unstructured grids ----

// The numeric arrays of `attributes`, converted by `convert(array, name)` and removed one after the other, so that few of
// them are held twice; texts and ghost marks are left out and left where they are.
template <class Convert>
std::vector<Field> take_fields(vtkDataSetAttributes& attributes, vtkIdType rows, const fs::path& place,
                               Convert convert) {
    std::vector<Field> fields;
    for (int i = 0, number = 0; i < attributes.GetNumberOfArrays(); ++i, ++number) {
        vtkDataArray* array = attributes.GetArray(i);
        if (!array || array->GetNumberOfComponents() < 1) continue;
        const std::string name = array->GetName() ? array->GetName() : "unnamed " + std::to_string(number);
        if (name == vtkDataSetAttributes::GhostArrayName()) continue;
        require_rows(*array, name, rows, place);
        fields.push_back(convert(*array, name));
        attributes.RemoveArray(i--);
    }
    return fields;
}

}  // namespace

Dataset to_dataset(vtkUnstructuredGrid& grid, const fs::path& place, const std::string& format) {
    Dataset dataset;
    dataset.source = place.string();
    dataset.format = format;
    const vtkIdType points = grid.GetNumberOfPoints();
    const vtkIdType cells = grid.GetNumberOfCells();
    if (grid.GetPoints()) dataset.points = to_points(*grid.GetPoints(), place);
    grid.SetPoints(nullptr);
    VolumeCells volume = read_cells(grid, points, place);
    grid.SetCells(VTK_TETRA, vtkNew<vtkCellArray>());
    add_offsets(volume.cells);
    dataset.cells = std::move(volume.cells);
    dataset.ghost_cells = volume.ghosts;
    dataset.skipped_cells = static_cast<std::size_t>(cells) - dataset.cells.size() - dataset.ghost_cells;
    dataset.point_fields =
        take_fields(*grid.GetPointData(), points, place,
                    [](vtkDataArray& array, const std::string& name) { return to_field(array, name); });
    dataset.cell_fields =
        take_fields(*grid.GetCellData(), cells, place, [&](vtkDataArray& array, const std::string& name) {
            const bool all = dataset.cells.size() == static_cast<std::size_t>(cells);
            return all ? to_field(array, name) : to_field(array, name, volume.rows);
        });
    return dataset;
}

}  // namespace cellproj
