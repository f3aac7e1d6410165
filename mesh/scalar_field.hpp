// SPDX-License-Identifier: BSD-3-Clause
//
// The scalar that is drawn: one number per point (linear inside a cell) or per cell (constant inside a cell).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

enum class FieldLocation { points, cells };

struct ScalarField {
    std::string name;  // as the user would type it
    FieldLocation location = FieldLocation::points;
    std::vector<double> values;  // #P or #T; may hold NaN and infinities

    double at(const TetMesh& mesh, CellId cell, int corner) const {
        return location == FieldLocation::points ? values[mesh.tets[cell][static_cast<std::size_t>(corner)]]
                                                 : values[cell];
    }
};

// The field called `name`, point fields before cell fields; a vector or tensor gives its magnitude (root of the sum of
// squares), or one component of it by "name:x", "name:y", "name:z" or "name:0", "name:1", … Names that hold a colon
// themselves are found first. Without an exact match, a match that differs in upper and lower case only is taken if it
// is the only one. "Points:x", "Points:y", "Points:z" are the coordinates where no field is called so. An empty name chooses
// `field_to_look_at` (which says what `added_points` are), without one the first scalar on points, on cells, then the first
// field of all. Throws Error (option) when there is no such field (the message lists those that exist) or no such component,
// Error (data) when there is no field at all. `place` names the file in messages.
ScalarField select_scalar(const TetMesh& mesh, const std::string& name, const std::string& place,
                          std::size_t added_points = 0);

// The name of the field that somebody is likely to look for first: a scalar that varies and is not made of whole numbers only
// (these count or mark: ids, materials, ghosts), else a vector or tensor whose magnitude varies, else whatever varies; points
// before cells, then as they stand in the file. The last `added_points` points are no points of the file: their values are
// means. Nothing when no field varies.
std::optional<std::string> field_to_look_at(const TetMesh& mesh, std::size_t added_points = 0);

// A field as a scalar: itself if it has one component, else the magnitude of each row.
ScalarField as_scalar(const Field& field, FieldLocation location);

// Component `component` (0 ≤ component < field.components) of each row, named "name:x" for the first three of fields of
// up to three components, "name:3" otherwise. Of a scalar: the field itself.
ScalarField as_scalar(const Field& field, FieldLocation location, int component);

// A field on cells, carried to the points: the mean over the cells around each point, weighted by their volumes (equal
// weights where all of them are flat). A constant stays that constant; what is linear in space is off by less than its
// change over the largest cell around the point, and not at all where the cells lie symmetrically around it. NaN and
// infinities spread to all points of their cells; points without cells get NaN. A field on points comes back as it is.
// Where not asked for, nothing is averaged: cell fields are drawn constant per cell, which is what the solver said.
ScalarField averaged_to_points(const TetMesh& mesh, const ScalarField& field);

// The field with `value`, which is finite, in place of NaN and infinities. Where not asked for, the cells that touch
// such values are left out of the picture.
ScalarField with_finite_values(ScalarField field, double value);

struct ScalarRange {
    double low = 0.0;
    double high = 0.0;
    std::size_t not_finite = 0;  // values left out: NaN and infinities
};

// Smallest and largest finite value; 0..0 when there is none.
ScalarRange range(const std::vector<double>& values);

// The value below which the fraction `share` (0..1) of the finite values lies; 0 when there is none.
double quantile(const std::vector<double>& values, double share);

}  // namespace cellproj
