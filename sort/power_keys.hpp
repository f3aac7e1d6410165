// SPDX-License-Identifier: BSD-3-Clause
//
// The order of a Delaunay mesh by one number per cell: the power of the eye with respect to the circumsphere, |e − c|² − r². The powers
// of two face neighbours differ by a linear function that vanishes on their face, so the cell on the eye's side has the smaller one
// (Edelsbrunner, "An acyclicity theorem for cell complexes in d dimension", Combinatorica 10, 1990). For an eye at infinity: the depth
// of the circumcentre.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sort/cell_graph.hpp"
#include "sort/depth_keys.hpp"

namespace cellproj {

// Memory: 17 bytes per cell.
class PowerKeys {
public:
    explicit PowerKeys(const CellGraph& graph);

    // Keys that grow from far to near; `no_key` for cells that are not visible. What is given must outlive the answer, as must this.
    FindKeys keys(const CellGraph& graph, const Eye& eye, std::span<const std::uint8_t> visible) const;

    // After sorting by these keys: makes `order` (places, back to front) respect the relations of all pairs of neighbours whose keys
    // rounding or a tie leaves in doubt, by exact signs. False when it cannot be proven that it does: too many such pairs (a regular grid),
    // or one with a cell that is not in the order. `scratch`: #T numbers to work with.
    bool settle(const CellGraph& graph, const Eye& eye, std::span<CellId> order, std::span<std::uint32_t> scratch) const;

private:
    struct Sphere {
        float x, y, z, power;  // centre; power of the origin
    };
    class View;

    std::vector<Sphere> spheres_;
    std::vector<std::uint8_t> slack_;  // #T: how far off a nearness may be, at most; see slacks in power_keys.cpp
};

}  // namespace cellproj
