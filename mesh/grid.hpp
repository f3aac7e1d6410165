// SPDX-License-Identifier: BSD-3-Clause
//
// A volume of boxes along x, y and z (WVG91's rectilinear sample volume) with the scalar to draw. A regular cell needs
// no neighbours, no sorting and no shape of its own: its place in the order and its projection follow from the axes.
//
// Conventions: points and cells are counted with i (x) fastest. Corner c of a cell lies at its high end along x, y, z
// where bit 0, 1, 2 of c is set. A position inside a cell is u in [0, 1]³, from the low to the high end of each axis.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/dataset.hpp"
#include "mesh/grid_axis.hpp"
#include "mesh/scalar_field.hpp"

namespace cellproj {

using GridCell = std::array<std::size_t, 3>;  // i, j, k

struct Grid {
    std::array<GridAxis, 3> axes;  // x, y, z; sound, ascending (grid_axis.hpp)
    FieldLocation location = FieldLocation::points;
    std::vector<double> values;         // one per point or per cell; finite at all cells that are not blanked
    std::vector<std::uint8_t> blanked;  // 1 for a cell that is left out; empty when none is

    GridDimensions dimensions() const { return {axes[0].points(), axes[1].points(), axes[2].points()}; }
    std::size_t cell_count() const { return dimensions().cells(); }
    std::size_t cell_id(const GridCell& c) const { return c[0] + axes[0].cells() * (c[1] + axes[1].cells() * c[2]); }
    bool is_blanked(const GridCell& c) const { return !blanked.empty() && blanked[cell_id(c)] != 0; }
    Bounds bounds() const;
    Bounds cell_bounds(const GridCell& c) const;
    glm::dvec3 cell_edges(const GridCell& c) const;  // lengths [mesh units]; equal for all cells of uniform axes
    // The scalar at the eight corners of a cell; its own value eight times for a field on cells.
    std::array<double, 8> corner_values(const GridCell& c) const;
};

// The share of each corner in the trilinear interpolation at u: products, so that 0 and 1 are exact. On an edge of the
// cell two are not 0 (linear), on a face at most four (bilinear).
std::array<double, 8> corner_weights(const glm::dvec3& u);

// The trilinear scalar of a cell at u: the sum of value times weight.
double interpolate(const std::array<double, 8>& corner_values, const glm::dvec3& u);

// The grid of a file of boxes (an image, a rectilinear grid, NRRD, MetaImage, SLC, raw voxels), with one of its fields,
// a row per point or cell of `dataset` (as_scalar). Axes that descend are turned round, values with them. Blanked: the
// cells that the file leaves out, and those that touch a value that is NaN or infinite. Throws Error (data), naming the
// file, when
// - the cells are those of no such grid: unstructured, curvilinear, an image turned against x, y, z, several blocks;
// - an axis is unsound (require_monotonic);
// - the field has another number of values;
// - no cell is left.
Grid make_grid(const Dataset& dataset, const ScalarField& field);

// The same for boxes of which all cells may be left out: a piece of a hierarchy (grid_hierarchy.hpp). `place` is that of the values.
Grid make_piece_grid(const BoxGrid& boxes, const ScalarField& field, const std::string& place);

// Throws Error (data) at `place` when a grid made by hand is not what `Grid` says: axes, number of values or of blanked
// cells, a value that is not finite at a cell that is not blanked.
void validate(const Grid& grid, const std::string& place);

}  // namespace cellproj
