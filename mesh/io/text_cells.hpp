// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: what the readers of our own share about cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/cell_faces.hpp"
#include "mesh/io/curved_cells.hpp"
#include "mesh/dataset.hpp"
#include "mesh/io/text_scanner.hpp"

namespace cellproj {

// Appends a cell to a list that is empty or well formed.
void append_cell(CellList& cells, CellKind kind, std::span<const VertexId> corners);

// Makes room for `count` more cells of a kind.
void reserve_cells(CellList& cells, CellKind kind, std::size_t count);

// Cells read from text, perhaps before the number of points is known.
class TextCells {
public:
    // The first id of the file is `first_id` (0 or 1).
    explicit TextCells(std::int64_t first_id) : first_id_(first_id) {}

    void reserve(CellKind kind, std::size_t count) { reserve_cells(cells_, kind, count); }
    // The next `nodes` ids are a cell, its corners first. Its extra nodes stand at `places` (curved_cells.hpp); none:
    // only the corners count. Throws Error (data) for an id below the first one.
    void read(TextScanner& scanner, CellKind kind, std::size_t nodes, std::span<const std::int8_t> places = {});
    // Throws Error (data) where the largest id was read when there is no such point.
    CellList take(const TextScanner& scanner, std::size_t points);
    const CurvedCells& curved() const { return curved_; }

private:
    CellList cells_;
    CurvedCells curved_;
    std::vector<VertexId> nodes_;  // of the cell at hand
    std::int64_t first_id_;
    VertexId largest_ = 0;
    std::size_t largest_position_ = 0;
};

glm::dvec3 read_point(TextScanner& scanner);

// Throws Error (data) when the dataset has no points, no cells, or more than ids can tell.
void require_volume_mesh(const Dataset& dataset);

}  // namespace cellproj
