// SPDX-License-Identifier: BSD-3-Clause
//
// TetGen 1.5 manual, section 5.2.1 (.node).
#include "mesh/io/tetgen_nodes.hpp"

#include "mesh/io/text_cells.hpp"

namespace cellproj {

std::size_t optional_tetgen_count(TextScanner& scanner, std::string_view what) {
    return scanner.line_at_end() ? 0 : scanner.count(what, tetgen_column_bytes);
}

void require_tetgen_index(TextScanner& scanner, std::int64_t expected) {
    if (scanner.integer("an index") == expected) return;
    scanner.fail_word("the index " + std::to_string(expected),
                      "indices rise by one from line to line; a column may be missing before");
}

std::vector<Field> empty_tetgen_fields(const std::string& name, std::size_t fields, std::size_t rows,
                                       bool number_a_single_one) {
    std::vector<Field> result(fields);
    for (std::size_t i = 0; i < fields; ++i) {
        result[i].name = fields > 1 || number_a_single_one ? name + "_" + std::to_string(i + 1) : name;
        result[i].values.resize(rows);
    }
    return result;
}

std::int64_t read_tetgen_nodes(TextScanner& scanner, Dataset& dataset) {
    const std::size_t points = scanner.count("the number of points", 4 * tetgen_column_bytes);
    if (const std::int64_t dimension = scanner.integer("the dimension"); dimension != 3) {
        scanner.fail_word("the dimension 3", "flat meshes have no volume", ErrorKind::data);
    }
    const std::size_t attributes = optional_tetgen_count(scanner, "the number of attributes");
    const std::size_t markers = optional_tetgen_count(scanner, "the number of boundary markers");
    if (markers > 1) scanner.fail_word("0 or 1 boundary markers");
    scanner.require_room(points, (4 + attributes + markers) * tetgen_column_bytes, "a number of points");
    if (points == 0) return 0;

    const std::int64_t first = scanner.integer("an index");
    if (first != 0 && first != 1) scanner.fail_word("an index that starts at 0 or 1");
    dataset.points.resize(points);
    dataset.point_fields = empty_tetgen_fields("attribute", attributes, points, true);
    if (markers == 1) dataset.point_fields.push_back({"boundary_marker", 1, std::vector<double>(points)});
    for (std::size_t i = 0; i < points; ++i) {
        if (i > 0) require_tetgen_index(scanner, first + static_cast<std::int64_t>(i));
        dataset.points[i] = read_point(scanner);
        for (Field& field : dataset.point_fields)
            field.values[i] = scanner.number("a value of a point");
    }
    return first;
}

}  // namespace cellproj
