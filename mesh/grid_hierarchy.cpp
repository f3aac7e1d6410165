// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/grid_hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <glm/common.hpp>

#include "mesh/grid_error.hpp"

namespace cellproj {

namespace {

// A place along an axis of a piece: in a cell, 0..1 from its low end.
struct AxisPlace {
    std::size_t cell;
    double share;
};

// Of a lattice plane in a piece; the cell above the plane, the last one at the piece's end.
AxisPlace axis_place(const PiecePlace& piece, std::size_t axis, std::int64_t plane) {
    const std::int64_t off = plane - piece.box.low[axis], step = piece.step[axis];
    const std::int64_t last = (piece.box.high[axis] - piece.box.low[axis]) / step - 1;
    const std::int64_t cell = std::min(off / step, last);
    return {static_cast<std::size_t>(cell), static_cast<double>(off - cell * step) / static_cast<double>(step)};
}

// The scalar on points there. Corners that have no share do not count: they may have no value.
double value_at(const Grid& grid, const std::array<AxisPlace, 3>& at) {
    const GridDimensions n = grid.dimensions();
    const std::array<double, 8> weights = corner_weights({at[0].share, at[1].share, at[2].share});
    double sum = 0;
    for (std::size_t c = 0; c < 8; ++c) {
        if (weights[c] == 0) continue;
        const std::size_t i = at[0].cell + (c & 1U), j = at[1].cell + (c >> 1U & 1U), k = at[2].cell + (c >> 2U);
        sum += weights[c] * grid.values[i + n.ni * (j + n.nj * k)];
    }
    return sum;
}

// The same within a cell that is known to touch the point, for a point on its upper faces, too.
std::optional<double> value_in_cell(const Grid& grid, const PiecePlace& piece, const LatticeIndex& lattice_cell, const LatticeIndex& point) {
    GridCell cell{};
    glm::dvec3 u(0);
    for (std::size_t a = 0; a < 3; ++a) {
        cell[a] = static_cast<std::size_t>((lattice_cell[a] - piece.box.low[a]) / piece.step[a]);
        const std::int64_t low = piece.box.low[a] + static_cast<std::int64_t>(cell[a]) * piece.step[a];
        u[static_cast<int>(a)] = static_cast<double>(point[a] - low) / static_cast<double>(piece.step[a]);
    }
    if (grid.is_blanked(cell)) return std::nullopt;
    return interpolate(grid.corner_values(cell), u);
}

// The lattice cells around a point.
std::array<LatticeIndex, 8> cells_around(const LatticeIndex& point) {
    std::array<LatticeIndex, 8> cells{};
    for (std::size_t c = 0; c < 8; ++c)
        for (std::size_t a = 0; a < 3; ++a) cells[c][a] = point[a] - (c >> a & 1U ? 0 : 1);
    return cells;
}

// Calls visit(point's number, its place) for the points on the faces of a piece.
template <class Visit>
void for_each_outer_point(const Grid& grid, const PiecePlace& piece, Visit visit) {
    const GridDimensions n = grid.dimensions();
    for (std::size_t k = 0; k < n.nk; ++k)
        for (std::size_t j = 0; j < n.nj; ++j) {
            const bool row = k == 0 || k + 1 == n.nk || j == 0 || j + 1 == n.nj;
            for (std::size_t i = 0; i < n.ni; i += row ? 1 : n.ni - 1) {
                const std::array<std::size_t, 3> index{i, j, k};
                LatticeIndex point{};
                for (std::size_t a = 0; a < 3; ++a) point[a] = piece.box.low[a] + static_cast<std::int64_t>(index[a]) * piece.step[a];
                visit(i + n.ni * (j + n.nj * k), point);
            }
        }
}

// Gives the points where pieces meet one value each: that of the coarsest cell there, of the first piece among those of one level. From
// the coarsest level on, so that what a finer one takes is final.
void join_points(GridHierarchy& hierarchy) {
    const Lattice& lattice = hierarchy.lattice;
    const HierarchyTree tree(lattice);
    for (int level = 0; level < lattice.levels; ++level) {
        std::map<LatticeIndex, double> of_level;
        for (std::size_t p = 0; p < hierarchy.pieces.size(); ++p) {
            const PiecePlace& piece = lattice.pieces[p];
            if (piece.level != level) continue;
            Grid& grid = hierarchy.pieces[p];
            for_each_outer_point(grid, piece, [&](std::size_t id, const LatticeIndex& point) {
                int coarsest = level;
                std::optional<double> value;
                for (const LatticeIndex& cell : cells_around(point)) {
                    const std::optional<std::size_t> box = tree.box_at(cell);
                    if (!box) continue;
                    const std::size_t other = tree.boxes()[*box].piece;
                    if (lattice.pieces[other].level >= coarsest) continue;
                    const std::optional<double> there = value_in_cell(hierarchy.pieces[other], lattice.pieces[other], cell, point);
                    if (!there) continue;
                    value = there;
                    coarsest = lattice.pieces[other].level;
                }
                if (std::isfinite(grid.values[id])) {
                    const auto [known, is_new] = of_level.emplace(point, value.value_or(grid.values[id]));
                    grid.values[id] = known->second;
                }
            });
        }
    }
}

// A uniform axis at planes of the lattice.
GridAxis lattice_axis(const Lattice& lattice, std::size_t axis, std::int64_t low, std::int64_t step, std::size_t points) {
    GridAxis result{{}, static_cast<double>(step) * lattice.spacing[axis]};
    for (std::size_t i = 0; i < points; ++i) result.coordinates.push_back(lattice.plane(axis, low + static_cast<std::int64_t>(i) * step));
    return result;
}

std::size_t cells_drawn(const Grid& grid) {
    return grid.cell_count() - static_cast<std::size_t>(std::count(grid.blanked.begin(), grid.blanked.end(), 1));
}

// Puts the planes of pieces where the lattice has them, and joins their points.
GridHierarchy joined(Lattice lattice, std::vector<Grid> pieces, const std::string& place) {
    GridHierarchy hierarchy{std::move(lattice), std::move(pieces)};
    for (std::size_t p = 0; p < hierarchy.pieces.size(); ++p) {
        const PiecePlace& piece = hierarchy.lattice.pieces[p];
        for (std::size_t a = 0; a < 3; ++a) {
            GridAxis& axis = hierarchy.pieces[p].axes[a];
            axis = lattice_axis(hierarchy.lattice, a, piece.box.low[a], piece.step[a], axis.points());
        }
    }
    if (hierarchy.visible_cells() == 0) refuse_grid(place, "a cell with finite values", "none", "choose another field");
    if (hierarchy.pieces.front().location == FieldLocation::points) join_points(hierarchy);
    return hierarchy;
}

std::vector<std::array<GridAxis, 3>> axes_of(const std::vector<Grid>& pieces) {
    std::vector<std::array<GridAxis, 3>> axes;
    for (const Grid& piece : pieces) axes.push_back(piece.axes);
    return axes;
}

}  // namespace

Bounds GridHierarchy::bounds() const {
    Bounds box = pieces.front().bounds();
    for (const Grid& piece : pieces) {
        box.low = glm::min(box.low, piece.bounds().low);
        box.high = glm::max(box.high, piece.bounds().high);
    }
    return box;
}

std::size_t GridHierarchy::visible_cells() const {
    std::size_t cells = 0;
    for (const Grid& piece : pieces) cells += cells_drawn(piece);
    return cells;
}

std::size_t GridHierarchy::cell_count() const {
    std::size_t cells = 0;
    for (const Grid& piece : pieces) cells += piece.cell_count();
    return cells;
}

GridHierarchy make_grid_hierarchy(const Dataset& dataset, const ScalarField& field) {
    if (dataset.pieces.empty()) refuse_grid(dataset.source, "a hierarchy of grids", dataset.format, "draw it as what it is");
    const std::string place = dataset.source + ", field \"" + field.name + "\"";
    const bool on_points = field.location == FieldLocation::points;
    std::size_t rows = 0;
    for (const PieceRows& piece : dataset.pieces) rows += on_points ? piece.points : piece.cells;
    if (field.values.size() != rows) {
        refuse_grid(place, std::to_string(rows) + " values", std::to_string(field.values.size()), "give every element one value");
    }
    std::vector<Grid> pieces;
    std::vector<std::string> names;
    auto row = field.values.begin();
    for (const PieceRows& piece : dataset.pieces) {
        const auto end = row + static_cast<std::ptrdiff_t>(on_points ? piece.points : piece.cells);
        pieces.push_back(make_piece_grid(piece.boxes, {field.name, field.location, {row, end}}, place + ", piece " + piece.name));
        names.push_back(piece.name);
        row = end;
    }
    Lattice lattice = place_pieces(axes_of(pieces), names, dataset.source);
    return joined(std::move(lattice), std::move(pieces), place);
}

GridHierarchy make_grid_hierarchy(std::vector<Grid> pieces, std::vector<std::string> names, const std::string& place) {
    Lattice lattice = place_pieces(axes_of(pieces), names, place);
    const auto covered = covered_cells(lattice, names, place);
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        validate(pieces[p], place + ", piece " + names[p]);
        if (pieces[p].location != pieces[0].location)
            refuse_grid(place + ", piece " + names[p], "values on points in all pieces, or on cells in all", "both", "carry them over");
        if (pieces[p].blanked.empty()) pieces[p].blanked.assign(pieces[p].cell_count(), 0);
        for (std::size_t c = 0; c < covered[p].size(); ++c)
            if (covered[p][c]) pieces[p].blanked[c] = 1;
    }
    return joined(std::move(lattice), std::move(pieces), place);
}

Grid grid_in_box(const GridHierarchy& hierarchy, const HierarchyBox& part) {
    const Grid& from = hierarchy.pieces[part.piece];
    const PiecePlace& piece = hierarchy.lattice.pieces[part.piece];
    Grid grid{{}, from.location, {}, {}};
    std::array<std::vector<AxisPlace>, 3> places;  // of its planes in the piece
    for (std::size_t a = 0; a < 3; ++a) {
        std::vector<std::int64_t> planes{part.box.low[a]};
        const std::int64_t step = piece.step[a], off = part.box.low[a] - piece.box.low[a];
        for (std::int64_t plane = piece.box.low[a] + (off / step + 1) * step; plane < part.box.high[a]; plane += step) planes.push_back(plane);
        planes.push_back(part.box.high[a]);
        const bool uncut = off % step == 0 && (part.box.high[a] - piece.box.low[a]) % step == 0;
        if (uncut) grid.axes[a].spacing = from.axes[a].spacing;
        for (const std::int64_t plane : planes) {
            grid.axes[a].coordinates.push_back(hierarchy.lattice.plane(a, plane));
            places[a].push_back(axis_place(piece, a, plane));
        }
    }
    const bool on_points = from.location == FieldLocation::points;
    const std::size_t less = on_points ? 0 : 1;
    for (std::size_t k = 0; k + less < places[2].size(); ++k)
        for (std::size_t j = 0; j + less < places[1].size(); ++j)
            for (std::size_t i = 0; i + less < places[0].size(); ++i) {
                const std::array<AxisPlace, 3> at{places[0][i], places[1][j], places[2][k]};
                grid.values.push_back(on_points ? value_at(from, at) : from.values[from.cell_id({at[0].cell, at[1].cell, at[2].cell})]);
            }
    std::vector<std::uint8_t> blanked;
    for (std::size_t k = 0; k + 1 < places[2].size(); ++k)
        for (std::size_t j = 0; j + 1 < places[1].size(); ++j)
            for (std::size_t i = 0; i + 1 < places[0].size(); ++i)
                blanked.push_back(from.is_blanked({places[0][i].cell, places[1][j].cell, places[2][k].cell}) ? 1 : 0);
    if (std::count(blanked.begin(), blanked.end(), 1) > 0) grid.blanked = std::move(blanked);
    return grid;
}

}  // namespace cellproj
