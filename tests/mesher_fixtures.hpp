// SPDX-License-Identifier: BSD-3-Clause
//
// Complexes and helpers shared by the tests of the mesher.
#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "mesh/error.hpp"
#include "mesh/mesher.hpp"

namespace cellproj::mesher_fixtures {

// The box between two corners, its faces as quadrilaterals; corner i has bit 1 of i for x, 2 for y, 4 for z.
inline void add_box(PiecewiseLinearComplex& complex, const glm::dvec3& low, const glm::dvec3& high) {
    const auto first = static_cast<VertexId>(complex.points.size());
    for (int i = 0; i < 8; ++i) {
        complex.points.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    }
    for (std::vector<VertexId> face :
         {std::vector<VertexId>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
        for (VertexId& v : face)
            v += first;
        complex.facets.push_back(std::move(face));
    }
}

inline PiecewiseLinearComplex unit_cube() {
    PiecewiseLinearComplex complex;
    add_box(complex, {0, 0, 0}, {1, 1, 1});
    return complex;
}

// The Error that `action` throws; fails the test when it throws none.
template <class Action>
Error error_of(const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no Error was thrown";
    return Error(ErrorParts{ErrorKind::format, "nowhere", "", "", ""});
}

}  // namespace cellproj::mesher_fixtures
