// SPDX-License-Identifier: BSD-3-Clause
//
// TetGen 1.5 manual, sections 5.2.1 (.node) and 5.2.4 (.ele).
#include <array>
#include <span>
#include <string>
#include <utility>

#include "mesh/text_cells.hpp"
#include "mesh/text_formats.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// A number and a blank or line end: the least that a column takes.
constexpr std::size_t column_bytes = 2;

// The first line of a file may leave its last columns out: they count as 0 then.
std::size_t optional_count(TextScanner& scanner, std::string_view what) {
    return scanner.line_at_end() ? 0 : scanner.count(what, column_bytes);
}

void require_index(TextScanner& scanner, std::int64_t expected) {
    if (scanner.integer("an index") == expected) return;
    scanner.fail_word("the index " + std::to_string(expected),
                      "indices rise by one from line to line; a column may be missing before");
}

std::vector<Field> empty_fields(const std::string& name, std::size_t fields, std::size_t rows,
                                bool number_a_single_one) {
    std::vector<Field> result(fields);
    for (std::size_t i = 0; i < fields; ++i) {
        result[i].name = fields > 1 || number_a_single_one ? name + "_" + std::to_string(i + 1) : name;
        result[i].values.resize(rows);
    }
    return result;
}

// Returns the index of the first point, 0 or 1, with which all indices of both files start.
std::int64_t read_nodes(TextScanner& scanner, Dataset& dataset) {
    const std::size_t points = scanner.count("the number of points", 4 * column_bytes);
    if (const std::int64_t dimension = scanner.integer("the dimension"); dimension != 3) {
        scanner.fail_word("the dimension 3", "flat meshes have no volume", ErrorKind::data);
    }
    const std::size_t attributes = optional_count(scanner, "the number of attributes");
    const std::size_t markers = optional_count(scanner, "the number of boundary markers");
    if (markers > 1) scanner.fail_word("0 or 1 boundary markers");
    scanner.require_room(points, (4 + attributes + markers) * column_bytes, "a number of points");
    if (points == 0) return 0;

    const std::int64_t first = scanner.integer("an index");
    if (first != 0 && first != 1) scanner.fail_word("an index that starts at 0 or 1");
    dataset.points.resize(points);
    dataset.point_fields = empty_fields("attribute", attributes, points, true);
    if (markers == 1) dataset.point_fields.push_back({"boundary_marker", 1, std::vector<double>(points)});
    for (std::size_t i = 0; i < points; ++i) {
        if (i > 0) require_index(scanner, first + static_cast<std::int64_t>(i));
        dataset.points[i] = read_point(scanner);
        for (Field& field : dataset.point_fields)
            field.values[i] = scanner.number("a value of a point");
    }
    return first;
}

// The nodes on the edges 01, 12, 20, 03, 13 and 23, as TetGen 1.5 writes them with -o2; its manual does not say.
constexpr std::array<std::int8_t, 6> edge_places{6, 7, 9, 5, 8, 4};

void read_elements(TextScanner& scanner, std::int64_t first, int subdivide, Dataset& dataset) {
    const std::size_t count = scanner.count("the number of tetrahedra", 5 * column_bytes);
    const std::int64_t nodes = scanner.integer("the number of nodes of a tetrahedron");
    if (nodes != 4 && nodes != 10) scanner.fail_word("4 or 10 nodes of a tetrahedron");
    const std::size_t attributes = optional_count(scanner, "the number of attributes");
    scanner.require_room(count, (1 + static_cast<std::size_t>(nodes) + attributes) * column_bytes,
                         "a number of tetrahedra");

    const bool is_curved = nodes == 10 && subdivide > 0;
    TextCells cells(first);
    cells.reserve(CellKind::tetrahedron, count);
    dataset.cell_fields = empty_fields("region", attributes, count, false);
    for (std::size_t i = 0; i < count; ++i) {
        require_index(scanner, first + static_cast<std::int64_t>(i));
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
        first = read_nodes(nodes, dataset);
    }
    TextScanner elements(with_suffix(file, ".ele"), '#');
    read_elements(elements, first, subdivide, dataset);
    require_volume_mesh(dataset);
    return dataset;
}

}  // namespace cellproj
