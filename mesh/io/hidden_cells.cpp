// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/hidden_cells.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "mesh/io/merge_blocks.hpp"

namespace cellproj {

namespace {

// The chosen rows, in place.
void keep_rows(std::vector<Field>& fields, const std::vector<std::size_t>& rows) {
    for (Field& field : fields) {
        const auto components = static_cast<std::size_t>(field.components);
        auto to = field.values.begin();
        for (const std::size_t row : rows) {  // ascending: never written before it is read
            to = std::copy_n(field.values.begin() + static_cast<std::ptrdiff_t>(row * components), components, to);
        }
        field.values.resize(rows.size() * components);
    }
}

void drop_unused_points(Dataset& dataset) {
    std::vector<bool> used(dataset.points.size(), false);
    for (const VertexId v : dataset.cells.vertices)
        used[v] = true;
    std::vector<VertexId> new_id(dataset.points.size());
    std::vector<std::size_t> rows;
    for (std::size_t p = 0; p < used.size(); ++p) {
        if (!used[p]) continue;
        new_id[p] = static_cast<VertexId>(rows.size());
        dataset.points[rows.size()] = dataset.points[p];
        rows.push_back(p);
    }
    dataset.points.resize(rows.size());
    for (VertexId& v : dataset.cells.vertices)
        v = new_id[v];
    keep_rows(dataset.point_fields, rows);
}

// The hexahedra of `all` that are not hidden, with their fields and the points that they have.
void keep_visible(Dataset& dataset, const CellList& all, const std::vector<bool>& hidden) {
    CellList kept;
    std::vector<std::size_t> rows;
    kept.offsets.push_back(0);
    for (std::size_t c = 0; c < all.size(); ++c) {
        if (hidden[c]) continue;
        rows.push_back(c);
        kept.kinds.push_back(all.kinds[c]);
        kept.vertices.insert(kept.vertices.end(), all.vertices.begin() + static_cast<std::ptrdiff_t>(8 * c),
                             all.vertices.begin() + static_cast<std::ptrdiff_t>(8 * c + 8));
        kept.offsets.push_back(kept.vertices.size());
    }
    dataset.ghost_cells += all.size() - rows.size();
    keep_rows(dataset.cell_fields, rows);
    dataset.cells = std::move(kept);
    dataset.grid.reset();
    drop_unused_points(dataset);
}

}  // namespace

void leave_out_cells(Dataset& dataset, const std::vector<bool>& hidden) {
    if (!dataset.grid) {  // some are left out already
        assert(dataset.boxes && hidden.size() == dataset.boxes->blanked.size());
        std::vector<bool> of_kept;
        for (std::size_t c = 0; c < hidden.size(); ++c) {
            std::uint8_t& blanked = dataset.boxes->blanked[c];
            if (!blanked) of_kept.push_back(hidden[c]);
            blanked |= hidden[c] ? 1U : 0U;
        }
        keep_visible(dataset, CellList(dataset.cells), of_kept);
        return;
    }
    assert(hidden.size() == dataset.grid->cells());
    if (std::find(hidden.begin(), hidden.end(), true) == hidden.end()) return;
    keep_visible(dataset, hexahedra_of(*dataset.grid), hidden);
    if (dataset.boxes) dataset.boxes->blanked.assign(hidden.begin(), hidden.end());
}

std::vector<bool> cells_touching(const GridDimensions& grid, const std::vector<bool>& hidden) {
    assert(hidden.size() == grid.ni * grid.nj * grid.nk);
    std::vector<bool> touching(grid.cells(), false);
    const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
        return hidden[i + grid.ni * (j + grid.nj * k)];
    };
    std::size_t cell = 0;
    for (std::size_t k = 0; k + 1 < grid.nk; ++k) {
        for (std::size_t j = 0; j + 1 < grid.nj; ++j) {
            for (std::size_t i = 0; i + 1 < grid.ni; ++i, ++cell) {
                touching[cell] = at(i, j, k) || at(i + 1, j, k) || at(i, j + 1, k) || at(i + 1, j + 1, k) ||
                                 at(i, j, k + 1) || at(i + 1, j, k + 1) || at(i, j + 1, k + 1) ||
                                 at(i + 1, j + 1, k + 1);
            }
        }
    }
    return touching;
}

}  // namespace cellproj
