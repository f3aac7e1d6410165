// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mesh/grid_error.hpp"

namespace cellproj {

namespace {

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

template <class Visit>
void for_each_cell(const GridDimensions& n, Visit visit) {
    for (std::size_t k = 0; k + 1 < n.nk; ++k) {
        for (std::size_t j = 0; j + 1 < n.nj; ++j) {
            for (std::size_t i = 0; i + 1 < n.ni; ++i)
                visit(GridCell{i, j, k});
        }
    }
}

std::array<std::size_t, 8> corner_points(const GridDimensions& n, const GridCell& c) {
    const std::size_t first = c[0] + n.ni * (c[1] + n.nj * c[2]), up = n.ni, deep = n.ni * n.nj;
    return {first,        first + 1,        first + up,        first + up + 1,
            first + deep, first + deep + 1, first + deep + up, first + deep + up + 1};
}

// Which points of the file's grid its dataset kept: those of the cells it kept.
std::vector<bool> kept_points(const GridDimensions& n, const std::vector<std::uint8_t>& blanked) {
    std::vector<bool> kept(n.ni * n.nj * n.nk, blanked.empty());
    if (blanked.empty()) return kept;
    std::size_t cell = 0;
    for_each_cell(n, [&](const GridCell& c) {
        if (blanked[cell++]) return;
        for (const std::size_t p : corner_points(n, c))
            kept[p] = true;
    });
    return kept;
}

// The values at their places in the whole grid, NaN where the dataset left points or cells out.
std::vector<double> spread(const std::vector<double>& values, const std::vector<bool>& kept, const std::string& place) {
    const auto count = static_cast<std::size_t>(std::count(kept.begin(), kept.end(), true));
    if (values.size() != count) {
        refuse_grid(place, std::to_string(count) + " values", std::to_string(values.size()), "give every element one value");
    }
    if (count == kept.size()) return values;
    std::vector<double> all(kept.size(), std::numeric_limits<double>::quiet_NaN());
    std::size_t row = 0;
    for (std::size_t p = 0; p < kept.size(); ++p) {
        if (kept[p]) all[p] = values[row++];
    }
    return all;
}

// The entries of an array over n[0] · n[1] · n[2] elements in the other order along the axes that descend.
template <class T>
void turn(std::vector<T>& entries, const std::array<std::size_t, 3>& n, const std::array<bool, 3>& descends) {
    if (entries.empty() || (!descends[0] && !descends[1] && !descends[2])) return;
    std::vector<T> turned(entries.size());
    std::size_t to = 0;
    for (std::size_t k = 0; k < n[2]; ++k) {
        for (std::size_t j = 0; j < n[1]; ++j) {
            for (std::size_t i = 0; i < n[0]; ++i) {
                const std::size_t x = descends[0] ? n[0] - 1 - i : i, y = descends[1] ? n[1] - 1 - j : j,
                                  z = descends[2] ? n[2] - 1 - k : k;
                turned[to++] = entries[x + n[0] * (y + n[1] * z)];
            }
        }
    }
    entries = std::move(turned);
}

void make_ascending(Grid& grid, const std::array<bool, 3>& descends) {
    const GridDimensions n = grid.dimensions();
    const std::array<std::size_t, 3> points{n.ni, n.nj, n.nk}, cells{n.ni - 1, n.nj - 1, n.nk - 1};
    turn(grid.values, grid.location == FieldLocation::points ? points : cells, descends);
    turn(grid.blanked, cells, descends);
    for (std::size_t a = 0; a < 3; ++a) {
        if (!descends[a]) continue;
        std::reverse(grid.axes[a].coordinates.begin(), grid.axes[a].coordinates.end());
        if (grid.axes[a].spacing) grid.axes[a].spacing = -*grid.axes[a].spacing;
    }
}

bool is_finite_at(const Grid& grid, const GridCell& c) {
    const std::array<double, 8> values = grid.corner_values(c);
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

void blank_cells_without_value(Grid& grid) {
    const std::size_t cells = grid.cell_count();
    std::size_t left = 0;
    for_each_cell(grid.dimensions(), [&](const GridCell& c) {
        if (grid.is_blanked(c)) return;
        if (is_finite_at(grid, c)) {
            ++left;
            return;
        }
        if (grid.blanked.empty()) grid.blanked.assign(cells, 0);
        grid.blanked[grid.cell_id(c)] = 1;
    });
    // A bitmap of the file that blanks nothing is none.
    if (left == cells) grid.blanked.clear();
}

void require_one_grid(const Dataset& dataset) {
    if (dataset.boxes) return;
    refuse_grid(dataset.source, "one grid of boxes along x, y and z",
         dataset.grid ? "a curvilinear grid, or an image turned against the axes"
                      : "an unstructured mesh, or several blocks (" + dataset.format + ")",
         "draw it as tetrahedra, or resample it");
}

}  // namespace

Bounds Grid::bounds() const {
    Bounds box{};
    for (std::size_t a = 0; a < 3; ++a) {
        box.low[static_cast<int>(a)] = axes[a].coordinates.front();
        box.high[static_cast<int>(a)] = axes[a].coordinates.back();
    }
    return box;
}

Bounds Grid::cell_bounds(const GridCell& c) const {
    Bounds box{};
    for (std::size_t a = 0; a < 3; ++a) {
        box.low[static_cast<int>(a)] = axes[a].coordinates[c[a]];
        box.high[static_cast<int>(a)] = axes[a].coordinates[c[a] + 1];
    }
    return box;
}

glm::dvec3 Grid::cell_edges(const GridCell& c) const {
    return {axes[0].width(c[0]), axes[1].width(c[1]), axes[2].width(c[2])};
}

std::array<double, 8> Grid::corner_values(const GridCell& c) const {
    std::array<double, 8> corners{};
    if (location == FieldLocation::cells) {
        corners.fill(values[cell_id(c)]);
        return corners;
    }
    const std::array<std::size_t, 8> ids = corner_points(dimensions(), c);
    std::transform(ids.begin(), ids.end(), corners.begin(), [&](std::size_t p) { return values[p]; });
    return corners;
}

std::array<double, 8> corner_weights(const glm::dvec3& u) {
    std::array<double, 8> weights{};
    for (std::size_t c = 0; c < 8; ++c) {
        weights[c] =
            ((c & 1U) != 0 ? u.x : 1.0 - u.x) * ((c & 2U) != 0 ? u.y : 1.0 - u.y) * ((c & 4U) != 0 ? u.z : 1.0 - u.z);
    }
    return weights;
}

double interpolate(const std::array<double, 8>& corner_values, const glm::dvec3& u) {
    const std::array<double, 8> weights = corner_weights(u);
    double sum = 0.0;
    for (std::size_t c = 0; c < 8; ++c)
        sum += weights[c] * corner_values[c];
    return sum;
}

Grid make_piece_grid(const BoxGrid& boxes, const ScalarField& field, const std::string& place) {
    Grid grid;
    grid.axes = boxes.axes;
    std::array<bool, 3> descends{};
    for (std::size_t a = 0; a < 3; ++a)
        descends[a] = require_monotonic(grid.axes[a], place + ", axis " + axis_names[a]) < 0;
    grid.location = field.location;
    grid.blanked = boxes.blanked;
    if (field.location == FieldLocation::points) {
        grid.values = spread(field.values, kept_points(grid.dimensions(), grid.blanked), place);
    } else {
        std::vector<bool> kept(grid.cell_count(), true);
        for (std::size_t c = 0; c < grid.blanked.size(); ++c)
            kept[c] = grid.blanked[c] == 0;
        grid.values = spread(field.values, kept, place);
    }
    make_ascending(grid, descends);
    blank_cells_without_value(grid);
    return grid;
}

Grid make_grid(const Dataset& dataset, const ScalarField& field) {
    require_one_grid(dataset);
    // Axes are told of without the field, which has no part in them.
    for (std::size_t a = 0; a < 3; ++a)
        require_monotonic(dataset.boxes->axes[a], dataset.source + ", axis " + axis_names[a]);
    const std::string place = dataset.source + ", field \"" + field.name + "\"";
    Grid grid = make_piece_grid(*dataset.boxes, field, place);
    if (!grid.blanked.empty() && std::count(grid.blanked.begin(), grid.blanked.end(), 0) == 0) {
        refuse_grid(place, "a cell with finite values", "none", "choose another field");
    }
    return grid;
}

void validate(const Grid& grid, const std::string& place) {
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string axis = place + ", axis " + axis_names[a];
        if (require_monotonic(grid.axes[a], axis) > 0) continue;
        refuse_grid(axis, "coordinates that ascend", "coordinates that descend", "turn the axis and its values round");
    }
    const GridDimensions n = grid.dimensions();
    const std::size_t rows = grid.location == FieldLocation::points ? n.ni * n.nj * n.nk : n.cells();
    if (grid.values.size() != rows) {
        refuse_grid(place, std::to_string(rows) + " values", std::to_string(grid.values.size()),
             "give every element one value");
    }
    if (!grid.blanked.empty() && grid.blanked.size() != n.cells()) {
        refuse_grid(place, "a mark for each of " + std::to_string(n.cells()) + " cells, or none",
             std::to_string(grid.blanked.size()), "give every cell one mark");
    }
    for_each_cell(n, [&](const GridCell& c) {
        if (grid.is_blanked(c) || is_finite_at(grid, c)) return;
        refuse_grid(place + ", cell " + std::to_string(grid.cell_id(c)), "finite values", "NaN or infinity", "blank the cell");
    });
}

}  // namespace cellproj
