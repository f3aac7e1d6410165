// SPDX-License-Identifier: BSD-3-Clause
//
// TetGen 1.5 manual, section 5.2.4 (.ele); tetgen_nodes.cpp reads the points.
#include <string>
#include <utility>

#include "mesh/text_cells.hpp"
#include "mesh/text_formats.hpp"
#include "mesh/tetgen_nodes.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

void read_elements(TextScanner& scanner, std::int64_t first, Dataset& dataset) {
    const std::size_t count = scanner.count("the number of tetrahedra", 5 * tetgen_column_bytes);
    const std::int64_t nodes = scanner.integer("the number of nodes of a tetrahedron");
    if (nodes != 4 && nodes != 10) scanner.fail_word("4 or 10 nodes of a tetrahedron");
    const std::size_t attributes = optional_tetgen_count(scanner, "the number of attributes");
    scanner.require_room(count, (1 + static_cast<std::size_t>(nodes) + attributes) * tetgen_column_bytes,
                         "a number of tetrahedra");

    TextCells cells(first);
    cells.reserve(CellKind::tetrahedron, count);
    dataset.cell_fields = empty_tetgen_fields("region", attributes, count, false);
    for (std::size_t i = 0; i < count; ++i) {
        require_tetgen_index(scanner, first + static_cast<std::int64_t>(i));
        cells.read(scanner, CellKind::tetrahedron, static_cast<std::size_t>(nodes));
        for (Field& field : dataset.cell_fields)
            field.values[i] = scanner.number("an attribute of a tetrahedron");
    }
    dataset.cells = cells.take(scanner, dataset.points.size());
}

fs::path with_suffix(fs::path file, const std::string& suffix) {
    return file.replace_extension(suffix);
}

}  // namespace

Dataset read_tetgen(const fs::path& file) {
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = "TetGen nodes and tetrahedra";
    std::int64_t first = 0;
    {
        TextScanner nodes(with_suffix(file, ".node"), '#');
        first = read_tetgen_nodes(nodes, dataset);
    }
    TextScanner elements(with_suffix(file, ".ele"), '#');
    read_elements(elements, first, dataset);
    require_volume_mesh(dataset);
    return dataset;
}

}  // namespace cellproj
