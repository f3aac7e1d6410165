// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/merge_blocks.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

// Appends the cells of a block whose points start at `first_point`.
void append_cells(CellList& all, const CellList& block, std::size_t first_point) {
    const auto shift = static_cast<VertexId>(first_point);
    const std::size_t first_entry = all.vertices.size();
    all.kinds.insert(all.kinds.end(), block.kinds.begin(), block.kinds.end());
    for (std::size_t c = 0; c < block.size(); ++c) {
        all.offsets.push_back(first_entry + block.offsets[c + 1]);
        const auto begin = static_cast<std::size_t>(block.offsets[c]);
        const auto end = static_cast<std::size_t>(block.offsets[c + 1]);
        if (block.kinds[c] != CellKind::polyhedron) {
            for (std::size_t v = begin; v < end; ++v)
                all.vertices.push_back(block.vertices[v] + shift);
            continue;
        }
        // A face stream: counts stay, ids move.
        all.vertices.push_back(block.vertices[begin]);
        for (std::size_t at = begin + 1; at < end;) {
            const std::size_t corners = block.vertices[at];
            all.vertices.push_back(block.vertices[at++]);
            for (std::size_t n = 0; n < corners; ++n)
                all.vertices.push_back(block.vertices[at++] + shift);
        }
    }
}

const Field* find_field(const std::vector<Field>& fields, const Field& like) {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& field) {
        return field.name == like.name && field.components == like.components;
    });
    return found == fields.end() ? nullptr : &*found;
}

bool has_name(const std::vector<Field>& fields, const std::string& name) {
    return std::any_of(fields.begin(), fields.end(), [&](const Field& field) { return field.name == name; });
}

using Fields = std::vector<Field> Dataset::*;

// The fields that any block has, each with the rows of all blocks. `rows(block)`: how many a block has.
template <class Rows>
std::vector<Field> join_fields(const std::vector<Dataset>& blocks, Fields fields, Rows rows) {
    std::vector<Field> all;
    for (const Dataset& block : blocks) {
        for (const Field& field : block.*fields) {
            if (!has_name(all, field.name)) all.push_back({field.name, field.components, {}});
        }
    }
    for (Field& field : all) {
        for (const Dataset& block : blocks) {
            if (const Field* own = find_field(block.*fields, field)) {
                field.values.insert(field.values.end(), own->values.begin(), own->values.end());
            } else {
                field.values.insert(field.values.end(), rows(block) * static_cast<std::size_t>(field.components),
                                    std::numeric_limits<double>::quiet_NaN());
            }
        }
    }
    return all;
}

void require_addressable(const std::vector<Dataset>& blocks, const std::filesystem::path& file) {
    std::size_t points = 0;
    for (const Dataset& block : blocks)
        points += block.points.size();
    if (points <= max_elements) return;
    throw Error({.kind = ErrorKind::data,
                 .place = file.string(),
                 .expected = "at most " + std::to_string(max_elements) + " points in all blocks (ids have 32 bits)",
                 .found = std::to_string(points),
                 .advice = "choose some of the blocks"});
}

}  // namespace

CellList hexahedra_of(const GridDimensions& grid) {
    CellList cells;
    cells.kinds.assign(grid.cells(), CellKind::hexahedron);
    cells.vertices.reserve(8 * grid.cells());
    cells.offsets.reserve(grid.cells() + 1);
    cells.offsets.push_back(0);
    const auto id = [&](std::size_t i, std::size_t j, std::size_t k) {
        return static_cast<VertexId>(i + grid.ni * (j + grid.nj * k));
    };
    for (std::size_t k = 0; k + 1 < grid.nk; ++k) {
        for (std::size_t j = 0; j + 1 < grid.nj; ++j) {
            for (std::size_t i = 0; i + 1 < grid.ni; ++i) {
                cells.vertices.insert(cells.vertices.end(), {id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k),
                                                             id(i, j + 1, k), id(i, j, k + 1), id(i + 1, j, k + 1),
                                                             id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)});
                cells.offsets.push_back(cells.vertices.size());
            }
        }
    }
    return cells;
}

Dataset merge_blocks(std::vector<Dataset> blocks, const std::filesystem::path& file) {
    if (blocks.size() == 1) return std::move(blocks.front());
    require_addressable(blocks, file);
    Dataset all;
    if (blocks.empty()) return all;
    all.source = blocks.front().source;
    all.format = blocks.front().format;
    all.cells.offsets.push_back(0);
    all.point_fields = join_fields(blocks, &Dataset::point_fields, [](const Dataset& d) { return d.points.size(); });
    all.cell_fields = join_fields(blocks, &Dataset::cell_fields, [](const Dataset& d) { return d.cell_count(); });
    for (Dataset& block : blocks) {
        append_cells(all.cells, block.grid ? hexahedra_of(*block.grid) : block.cells, all.points.size());
        all.points.insert(all.points.end(), block.points.begin(), block.points.end());
        all.skipped_cells += block.skipped_cells;
        all.ghost_cells += block.ghost_cells;
        block = Dataset();  // gives its memory back before the next one is copied
    }
    return all;
}

bool is_chosen(const std::string& name, std::span<const std::string> wanted) {
    return wanted.empty() || std::any_of(wanted.begin(), wanted.end(), [&](const std::string& word) {
               return name == word || name.starts_with(word + "/") || name.ends_with("/" + word);
           });
}

void require_known_blocks(std::span<const std::string> wanted, std::span<const std::string> names,
                          const std::filesystem::path& file) {
    for (const std::string& word : wanted) {
        const std::span<const std::string> alone(&word, 1);
        if (std::any_of(names.begin(), names.end(), [&](const std::string& n) { return is_chosen(n, alone); }))
            continue;
        constexpr std::size_t most = 20;
        std::string list;
        for (std::size_t n = 0; n < names.size() && n < most; ++n)
            list += (n == 0 ? "\"" : ", \"") + names[n] + "\"";
        if (names.size() > most) list += " and " + std::to_string(names.size() - most) + " more";
        throw Error({.kind = ErrorKind::option,
                     .place = file.string() + ", block " + word,
                     .expected = names.empty() ? "a file of several blocks" : "one of the volume blocks " + list,
                     .found = names.empty() ? "one without block names" : "none of that name",
                     .advice = names.empty() ? "leave the choice of blocks out" : "check the name"});
    }
}

}  // namespace cellproj
