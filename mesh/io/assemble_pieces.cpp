// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/assemble_pieces.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "mesh/grid_error.hpp"
#include "mesh/grid_pieces.hpp"
#include "mesh/io/hidden_cells.hpp"
#include "mesh/io/merge_blocks.hpp"

namespace cellproj {

namespace {

std::string at(const std::string& place, const std::string& piece) { return place + ", piece " + piece; }

const Field* find_like(const std::vector<Field>& fields, const Field& field) {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& other) {
        return other.name == field.name && other.components == field.components;
    });
    return found == fields.end() ? nullptr : &*found;
}

void require_same_fields(const std::vector<Dataset>& pieces, std::span<const std::string> names, const std::string& place) {
    const auto require = [&](std::size_t p, const std::vector<Field>& all, const std::vector<Field>& own, std::size_t whose, const char* where) {
        for (const Field& field : all) {
            if (find_like(own, field)) continue;
            refuse_grid(at(place, names[p]), "the field \"" + field.name + "\" on " + where + ", as piece " + names[whose] + " has it",
                        "none of that name and number of components", "write the same fields for all pieces");
        }
    };
    for (std::size_t p = 1; p < pieces.size(); ++p) {
        require(p, pieces[0].point_fields, pieces[p].point_fields, 0, "points");
        require(p, pieces[0].cell_fields, pieces[p].cell_fields, 0, "cells");
        require(0, pieces[p].point_fields, pieces[0].point_fields, p, "points");
        require(0, pieces[p].cell_fields, pieces[0].cell_fields, p, "cells");
    }
}

}  // namespace

Dataset assemble_pieces(std::vector<Dataset> pieces, std::vector<std::string> names, const std::string& place) {
    std::vector<std::array<GridAxis, 3>> axes;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        if (!pieces[p].boxes) {
            refuse_grid(at(place, names[p]), "a grid of boxes along x, y and z", pieces[p].format + ", which is none, or is turned against the axes",
                        "resample the piece");
        }
        axes.push_back(pieces[p].boxes->axes);
    }
    require_same_fields(pieces, names, place);
    const Lattice lattice = place_pieces(axes, names, place);
    const auto covered = covered_cells(lattice, names, place);
    std::vector<PieceRows> rows;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        leave_out_cells(pieces[p], covered[p]);
        PieceRows& own = rows.emplace_back();
        own.name = names[p];
        own.boxes = *pieces[p].boxes;
        own.points = pieces[p].points.size();
        own.cells = pieces[p].cell_count();
    }
    const std::string format = pieces.front().format;
    if (pieces.size() > 1) pieces.front().boxes.reset();
    Dataset all = merge_blocks(std::move(pieces), place);
    all.source = place;
    all.format = std::to_string(rows.size()) + " pieces, " + std::to_string(lattice.levels) + " levels: " + format;
    if (rows.size() > 1) all.pieces = std::move(rows);
    return all;
}

}  // namespace cellproj
