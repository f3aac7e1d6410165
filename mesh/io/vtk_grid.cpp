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

#include <array>
#include <cctype>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "mesh/cell_faces.hpp"
#include "mesh/io/curved_cells.hpp"
#include "mesh/error.hpp"
#include "mesh/io/lagrange_cells.hpp"
#include "mesh/io/vtk_conversion.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// ---- Cells ----

// Where the extra nodes of a curved cell stand in VTK's list (curved_cells.hpp has their order); -1 for none.
using Places = std::span<const std::int8_t>;
constexpr std::array<std::int8_t, 6> tet_places{4, 5, 6, 7, 8, 9};
constexpr std::array<std::int8_t, 19> hex_20_places{8,  9,  10, 11, 12, 13, 14, 15, 16, 17,
                                                    18, 19, -1, -1, -1, -1, -1, -1, -1};
constexpr std::array<std::int8_t, 19> hex_24_places{8,  9,  10, 11, 12, 13, 14, 15, 16, 17,
                                                    18, 19, -1, -1, 22, 21, 23, 20, -1};
constexpr std::array<std::int8_t, 19> hex_27_places{8,  9,  10, 11, 12, 13, 14, 15, 16, 17,
                                                    18, 19, 24, 25, 22, 21, 23, 20, 26};
constexpr std::array<std::int8_t, 12> wedge_12_places{6, 7, 8, 9, 10, 11, -1, -1, -1, -1, -1, -1};
constexpr std::array<std::int8_t, 12> wedge_15_places{6, 7, 8, 9, 10, 11, 12, 13, 14, -1, -1, -1};
constexpr std::array<std::int8_t, 12> wedge_18_places{6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17};
constexpr std::array<std::int8_t, 9> pyramid_13_places{5, 6, 7, 8, 9, 10, 11, 12, -1};
constexpr std::array<std::int8_t, 9> pyramid_19_places{5, 6, 7, 8, 9, 10, 11, 12, 13};

// How a VTK type becomes one of ours. Cells of higher order list their corners first, in the order of the linear kind.
struct KindRule {
    CellKind kind;
    std::size_t nodes = 0;  // in VTK's list; 0: as many as it likes, the corners first
    Places places = {};     // of second order
    bool is_lagrange = false;
};

KindRule linear(CellKind kind) {
    return {kind, vertex_count(kind)};
}

std::optional<KindRule> rule_for(int vtk_type) {
    switch (vtk_type) {
        case VTK_TETRA:
            return linear(CellKind::tetrahedron);
        case VTK_VOXEL:
        case VTK_HEXAHEDRON:
            return linear(CellKind::hexahedron);
        case VTK_WEDGE:
            return linear(CellKind::wedge);
        case VTK_PYRAMID:
            return linear(CellKind::pyramid);
        case VTK_PENTAGONAL_PRISM:
            return linear(CellKind::pentagonal_prism);
        case VTK_HEXAGONAL_PRISM:
            return linear(CellKind::hexagonal_prism);
        case VTK_POLYHEDRON:
            return linear(CellKind::polyhedron);
        case VTK_QUADRATIC_TETRA:
            return KindRule{CellKind::tetrahedron, 10, tet_places};
        case VTK_QUADRATIC_HEXAHEDRON:
            return KindRule{CellKind::hexahedron, 20, hex_20_places};
        case VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON:
            return KindRule{CellKind::hexahedron, 24, hex_24_places};
        case VTK_TRIQUADRATIC_HEXAHEDRON:
            return KindRule{CellKind::hexahedron, 27, hex_27_places};
        case VTK_QUADRATIC_WEDGE:
            return KindRule{CellKind::wedge, 15, wedge_15_places};
        case VTK_QUADRATIC_LINEAR_WEDGE:
            return KindRule{CellKind::wedge, 12, wedge_12_places};
        case VTK_BIQUADRATIC_QUADRATIC_WEDGE:
            return KindRule{CellKind::wedge, 18, wedge_18_places};
        case VTK_QUADRATIC_PYRAMID:
            return KindRule{CellKind::pyramid, 13, pyramid_13_places};
        case VTK_TRIQUADRATIC_PYRAMID:
            return KindRule{CellKind::pyramid, 19, pyramid_19_places};
        case VTK_LAGRANGE_TETRAHEDRON:
            return KindRule{CellKind::tetrahedron, 0, {}, true};
        case VTK_LAGRANGE_HEXAHEDRON:
            return KindRule{CellKind::hexahedron, 0, {}, true};
        case VTK_LAGRANGE_WEDGE:
            return KindRule{CellKind::wedge, 0, {}, true};
        // The inner control points of a Bézier cell do not lie on it; its corners do.
        case VTK_BEZIER_TETRAHEDRON:
            return KindRule{CellKind::tetrahedron};
        case VTK_BEZIER_HEXAHEDRON:
            return KindRule{CellKind::hexahedron};
        case VTK_BEZIER_WEDGE:
            return KindRule{CellKind::wedge};
        case VTK_LAGRANGE_PYRAMID:
        case VTK_BEZIER_PYRAMID:
            return KindRule{CellKind::pyramid};
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

struct VolumeCells {
    CellList cells;
    CurvedCells curved;
    std::vector<std::uint64_t> rows;  // #C: where each cell stands in the file, 0-based; empty when that is its own number
    std::size_t in_file = 0;          // volume cells there, before Lagrange cells are cut
    std::size_t ghosts = 0;           // volume cells left out
};

// VTK's marks for cells and points that are not to be drawn, one number per row, bits of vtkDataSetAttributes.
class GhostMarks {
public:
    // Throws Error (format) when there are marks, but not one for each of `rows` rows.
    GhostMarks(vtkDataSetAttributes& attributes, vtkIdType rows, const fs::path& place)
        : marks_(attributes.GetArray(vtkDataSetAttributes::GhostArrayName())) {
        if (marks_)
            require_rows(*marks_, vtkDataSetAttributes::GhostArrayName(), static_cast<std::size_t>(rows), place);
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
          degrees_(grid.GetCellData()->GetHigherOrderDegrees()),
          place_(place) {}

    // Cells of higher order by their corners only, unless `at_nodes`.
    VolumeCells read(bool at_nodes) {
        VolumeCells result;
        std::vector<VertexId>& list = result.cells.vertices;
        // At most so many but for polyhedra; growing by doubling would hold up to three times as much.
        result.cells.kinds.reserve(static_cast<std::size_t>(types_.GetNumberOfValues()));
        list.reserve(static_cast<std::size_t>(cells_.GetNumberOfConnectivityIds()));
        for (cell_ = 0; cell_ < types_.GetNumberOfValues(); ++cell_) {
            const std::size_t begin = list.size(), before = result.cells.size();
            const int type = types_.GetValue(cell_);
            const std::optional<KindRule> rule = rule_for(type);
            if (!rule) continue;
            ++result.in_file;
            hidden_ = cell_marks_.has(cell_, vtkDataSetAttributes::DUPLICATECELL | vtkDataSetAttributes::HIDDENCELL);
            if (rule->kind == CellKind::polyhedron) {
                append_face_stream(list);
            } else {
                append_nodes(*rule);
                list.insert(list.end(), nodes_.begin(),
                            nodes_.begin() + static_cast<std::ptrdiff_t>(vertex_count(rule->kind)));
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
            if (at_nodes && !rule->places.empty()) result.curved.add(result.cells.size(), nodes_, rule->places);
            if (const int order = at_nodes && rule->is_lagrange ? lagrange_order(rule->kind) : 1; order > 1) {
                list.resize(begin);
                append_lagrange_pieces(rule->kind, order, nodes_, result.cells);
            } else {
                result.cells.kinds.push_back(rule->kind);
            }
            add_rows(result, before);
        }
        return result;
    }

private:
    // The row of the cell at hand for all cells from number `before` on. Rows are kept from the first one on that differs
    // from its cell's own number.
    void add_rows(VolumeCells& result, std::size_t before) const {
        const std::size_t cells = result.cells.size(), row = static_cast<std::size_t>(cell_);
        if (result.rows.empty() && before == row && cells == row + 1) return;
        if (result.rows.empty()) {
            result.rows.resize(before);
            std::iota(result.rows.begin(), result.rows.end(), std::uint64_t{0});
        }
        result.rows.resize(cells, row);
    }

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

    // All nodes of the cell into nodes_.
    void append_nodes(const KindRule& rule) {
        nodes_.clear();
        if (cells_.IsStorage64Bit()) {
            append_nodes(rule, *cells_.GetOffsetsArray64(), *cells_.GetConnectivityArray64());
        } else {
            append_nodes(rule, *cells_.GetOffsetsArray32(), *cells_.GetConnectivityArray32());
        }
    }

    template <class Array>
    void append_nodes(const KindRule& rule, Array& offsets, Array& connectivity) {
        const vtkIdType begin = offsets.GetValue(cell_);
        const vtkIdType end = offsets.GetValue(cell_ + 1);
        const auto count = static_cast<vtkIdType>(rule.nodes > 0 ? rule.nodes : vertex_count(rule.kind));
        const bool fits = rule.nodes == 0 ? end - begin >= count : end - begin == count;
        if (begin < 0 || end < begin || end > connectivity.GetNumberOfValues() || !fits) {
            fail(ErrorKind::format, std::to_string(count) + " vertices",
                 "those from " + std::to_string(begin) + " to " + std::to_string(end) + " of a list of " +
                     std::to_string(connectivity.GetNumberOfValues()));
        }
        for (vtkIdType v = begin; v < end; ++v)
            append_point(connectivity.GetValue(v), nodes_);
    }

    // Of the cell whose nodes are at hand; 1 where its order differs from direction to direction.
    int lagrange_order(CellKind kind) const {
        const int order = order_of_lagrange_cell(kind, nodes_.size());
        if (!degrees_ || cell_ >= degrees_->GetNumberOfTuples()) return order;
        for (int d = 0; d < degrees_->GetNumberOfComponents(); ++d) {
            if (degrees_->GetComponent(cell_, d) != order) return 1;
        }
        return order;
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
    vtkDataArray* degrees_;  // orders of Lagrange cells in each direction; null: the same in all
    const fs::path& place_;

    vtkIdType cell_ = 0;           // the one at hand
    std::vector<VertexId> nodes_;  // its nodes, corners first; of no polyhedron
    bool hidden_ = false;          // whether it is
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
    cells.offsets.assign(1, 0);  // pieces of Lagrange cells came with theirs
    for (const CellKind kind : cells.kinds) {
        const std::uint64_t begin = cells.offsets.back();
        cells.offsets.push_back(begin + entries_of(kind, cells.vertices.data() + begin));
    }
}

VolumeCells read_cells(vtkUnstructuredGrid& grid, vtkIdType points, const fs::path& place, bool at_nodes) {
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
    return VolumeCellReader(grid, points, place).read(at_nodes);
}

}  // namespace

Dataset to_dataset(vtkUnstructuredGrid& grid, const fs::path& place, const std::string& format, int subdivide) {
    Dataset dataset;
    dataset.source = place.string();
    dataset.format = format;
    const vtkIdType points = grid.GetNumberOfPoints();
    const vtkIdType cells = grid.GetNumberOfCells();
    if (grid.GetPoints()) dataset.points = to_points(*grid.GetPoints(), place);
    grid.SetPoints(nullptr);
    VolumeCells volume = read_cells(grid, points, place, subdivide > 0);
    grid.SetCells(VTK_TETRA, vtkNew<vtkCellArray>());
    add_offsets(volume.cells);
    dataset.cells = std::move(volume.cells);
    dataset.ghost_cells = volume.ghosts;
    dataset.skipped_cells = static_cast<std::size_t>(cells) - volume.in_file;
    dataset.point_fields =
        to_fields(*grid.GetPointData(), static_cast<std::size_t>(points), place,
                  [](vtkDataArray& array, const std::string& name) { return to_field(array, name); });
    dataset.cell_fields =
        to_fields(*grid.GetCellData(), static_cast<std::size_t>(cells), place,
                  [&](vtkDataArray& array, const std::string& name) {
                      return volume.rows.empty() ? to_field(array, name) : to_field(array, name, volume.rows);
                  });
    subdivide_at_nodes(dataset, volume.curved);
    return dataset;
}

}  // namespace cellproj
