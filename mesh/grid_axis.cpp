// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/grid_axis.hpp"

#include <cmath>
#include <cstdio>

#include "mesh/grid_error.hpp"

namespace cellproj {

namespace {

std::string to_words(double number) {
    std::string text(32, '\0');
    text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.17g", number)));
    return text;
}

}  // namespace

GridAxis uniform_axis(double first, double spacing, std::size_t points) {
    GridAxis axis{{}, spacing};
    axis.coordinates.reserve(points);
    for (std::size_t i = 0; i < points; ++i)
        axis.coordinates.push_back(first + static_cast<double>(i) * spacing);
    return axis;
}

int require_monotonic(const GridAxis& axis, const std::string& place) {
    if (axis.points() < 2) {
        refuse_grid(place, "at least 2 points", std::to_string(axis.points()),
             "a point, a line or a surface has no volume to draw");
    }
    if (axis.spacing && (!std::isfinite(*axis.spacing) || *axis.spacing == 0.0)) {
        refuse_grid(place, "a spacing that is finite and not 0", to_words(*axis.spacing), "give the true spacing");
    }
    int direction = 0;
    for (std::size_t i = 0; i < axis.points(); ++i) {
        const double x = axis.coordinates[i];
        const std::string here = place + ", point " + std::to_string(i);
        if (!std::isfinite(x)) refuse_grid(here, "a finite coordinate", to_words(x), "look for the program that wrote it");
        if (i == 0) continue;
        const double before = axis.coordinates[i - 1];
        if (x == before) {
            refuse_grid(here, "a coordinate other than that of the point before", to_words(x),
                 "leave repeated points out; a spacing far below the last digit of the coordinates needs another "
                 "origin");
        }
        const int step = x > before ? 1 : -1;
        if (direction == 0) direction = step;
        if (step == direction) continue;
        refuse_grid(here,
             direction > 0 ? "coordinates that ascend, as those before" : "coordinates that descend, as those before",
             to_words(x) + " behind " + to_words(before), "sort the axis and its values");
    }
    return direction;
}

}  // namespace cellproj
