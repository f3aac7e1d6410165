// SPDX-License-Identifier: BSD-3-Clause
//
// TetGen 1.5 manual, section 5.2.4 (.ele); tetgen_nodes.cpp reads the points.
#include <array>
#include <span>
#include <string>
#include <utility>

#include "mesh/io/text_cells.hpp"
#include "mesh/text_formats.hpp"
#include "mesh/io/tetgen_nodes.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// The nodes on the edges 01, 12, 20, 03, 13 and 23, as TetGen 1.5 writes them with -o2; its manual does not say.
constexpr std::array<std::int8_t, 6> edge_places{6, 7, 9, 5, 8, 4};

void read_elements(TextScanner& scanner, std::int64_t first, int subdivide, Dataset& dataset) {
    const std::size_t count = scanner.count("the number of tetrahedra", 5 * tetgen_column_bytes);
    const std::int64_t nodes = scanner.integer("the number of nodes of a tetrahedron");
    if (nodes != 4 && nodes != 10) scanner.fail_word("4 or 10 nodes of a tetrahedron");
    const std::size_t attributes = optional_tetgen_count(scanner, "the number of attributes");
    scanner.require_room(count, (1 + static_cast<std::size_t>(nodes) + attributes) * tetgen_column_bytes,
                         "a number of tetrahedra");

    const bool is_curved = nodes == 10 && subdivide > 0;
    TextCells cells(first);
    cells.reserve(CellKind::tetrahedron, count);
    dataset.cell_fields = empty_tetgen_fields("region", attributes, count, false);
    for (std::size_t i = 0; i < count; ++i) {
        require_tetgen_index(scanner, first + static_cast<std::int64_t>(i));
        cells.read(scanner, CellKind::tetrahedron, static_cast<std::size_t>(nodes),
                   is_curved ? std::span<const std::int8_t>(edge_places) : std::span<const std::int8_t>());
        for (Field& field : dataset.cell_fields)
            field.values[i] = scanner.number("an attribute of a tetrahedron");
    }
    dataset.cells = cells.take(scanner, dataset.points.size());
    subdivide_at_nodes(dataset, cells.curved());
}

fs::path with_suffix(fs::path file, const std::string& suffix) {
    return file.replace_extension(suffix);
}

}  // namespace

Dataset read_tetgen(const fs::path& file, int subdivide) {
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = "TetGen nodes and tetrahedra";
    std::int64_t first = 0;
    {
        TextScanner nodes(with_suffix(file, ".node"), '#');
        first = read_tetgen_nodes(nodes, dataset);
    }
    TextScanner elements(with_suffix(file, ".ele"), '#');
    read_elements(elements, first, subdivide, dataset);
    require_volume_mesh(dataset);
    return dataset;
}

}  // namespace cellproj
