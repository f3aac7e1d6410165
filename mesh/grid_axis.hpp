// SPDX-License-Identifier: BSD-3-Clause
//
// One axis of a grid whose cells are boxes along x, y and z.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace cellproj {

struct GridAxis {
    std::vector<double> coordinates;  // of its points [mesh units]; sound ones are finite, at least two, and ascend
    std::optional<double> spacing;    // of a uniform axis: coordinates are first + i · spacing, rounded

    std::size_t points() const { return coordinates.size(); }
    std::size_t cells() const { return coordinates.size() - 1; }
    // The edge length of cell i [mesh units]: on a uniform axis the same for all, which rounded coordinates are not.
    double width(std::size_t i) const { return spacing ? *spacing : coordinates[i + 1] - coordinates[i]; }
};

GridAxis uniform_axis(double first, double spacing, std::size_t points);

// +1 for an axis that ascends strictly, −1 for one that descends strictly. Throws Error (data) at `place`, which names
// the first offender, for fewer than two points, a coordinate or spacing that is not finite, a spacing of 0, neighbours
// that coincide (a spacing too small beside the coordinates does that, too) and axes that turn round.
int require_monotonic(const GridAxis& axis, const std::string& place);

}  // namespace cellproj
