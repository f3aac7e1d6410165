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

namespace cellproj {

// Memory: 20 bytes per cell, 8 more once keys were found.
class PowerKeys {
public:
    explicit PowerKeys(const CellGraph& graph);

    // Keys that grow from far to near; `no_key` for cells that are not visible.
    void find(const CellGraph& graph, const Eye& eye, std::span<const std::uint8_t> visible, std::span<std::uint32_t> keys);

    // After `find` and sorting: makes `order` (places, back to front) respect the relations of all pairs of neighbours whose keys
    // rounding or a tie leaves in doubt, by exact signs. False when it cannot be proven that it does: too many such pairs (a regular grid),
    // or one with a cell that is not in the order.
    bool settle(const CellGraph& graph, const Eye& eye, std::span<CellId> order);

private:
    struct Sphere {
        float x, y, z, power;  // centre; power of the origin
    };
    bool doubtful(std::size_t a, std::size_t b) const;

    std::vector<Sphere> spheres_;
    std::vector<float> slack_;     // #T: how far off a nearness may be; infinite for flat cells
    std::vector<float> nearness_;  // #T, of the last eye
    std::vector<std::uint32_t> position_;
};

}  // namespace cellproj
