// SPDX-License-Identifier: BSD-3-Clause
//
// The order of a convex mesh for an eye that moves in small steps, at a cost that is mostly that of what changes.
//
// Relations are kinetic: with those of a cell stands how far the eye may move before one of them can change, so that a step asks only
// the cells whose allowance is used up. The order is one of labels: numbers that grow from each cell to all that hide it. They start as depth keys;
// where a new relation finds them the wrong way round, the cell in front gets a larger one, and those in front of that as needed, which
// ends at the least labels that fit. Keys by depth make these changes few and local: a face that the eye has just
// crossed the plane of has its two cells side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "sort/cell_graph.hpp"

namespace cellproj {

// Memory: 15 bytes per cell.
class CoherentOrder {
public:
    // Orders all cells for an eye, from scratch. False, and empty, when labels do not get there within a bounded time: there is a cycle, or depth
    // is too far from the order.
    bool start(const CellGraph& graph, const Eye& eye);
    // The same for an eye near the last one, and of its kind: a point or a direction.
    bool follow(const CellGraph& graph, const Eye& eye);

    bool empty() const { return cells_.empty(); }
    // In the caller's numbers, back to front; all relations between face neighbours hold.
    std::span<const CellId> cells() const { return cells_; }
    void release() { *this = {}; }

private:
    struct Claim {  // `place` must have a label of at least this
        CellId place;
        std::uint32_t label;
    };

    enum class Asked { new_relations, all_relations };

    void label_by_depth(const CellGraph& graph, const Eye& eye);
    bool bring_up_to(const CellGraph& graph, const Eye& eye, Asked asked);
    void advance_clock(double distance);
    std::vector<Claim> find_claims(const CellGraph& graph, const Eye& eye, Asked asked);
    void renew_relations(const CellGraph& graph, const Eye& eye, std::span<const CellId> places, std::vector<Claim>* claims);
    void claim(const CellGraph& graph, CellId place, unsigned faces, std::vector<Claim>& claims) const;
    bool raise(const CellGraph& graph, std::span<const Claim> claims, std::vector<Claim>& raised);
    void move_cells(const CellGraph& graph, std::span<const Claim> raised);

    std::vector<CellGraph::Relations> relations_;  // #T: those of the last eye
    std::vector<std::uint16_t> expiry_;            // #T: on the clock, when a cell's relations must be asked again
    std::vector<std::uint32_t> label_;             // #T, by place
    std::vector<CellId> cells_;                    // #T: the order
    std::vector<std::uint32_t> sorted_labels_;     // #T: the label of each of `cells_`, ascending
    std::vector<std::uint64_t> moving_;            // a bit per cell, in the caller's numbers: its label has been raised
    glm::dvec3 eye_{0.0};                          // scaled, the last one
    double clock_ = 0.0, unit_ = 1.0;              // how far the eye has come, in units; the unit, scaled
    std::size_t raised_ = 0;                       // labels, since they began with depth
};

}  // namespace cellproj
