// SPDX-License-Identifier: BSD-3-Clause
//
// SU2 documentation, "Mesh File". Lines "KEY= value", each followed by the lines it announces.
#include <algorithm>
#include <optional>
#include <string>

#include "mesh/io/text_cells.hpp"
#include "mesh/text_formats.hpp"

namespace cellproj {

namespace {

// VTK's type numbers.
std::optional<CellKind> volume_kind(std::int64_t type) {
    switch (type) {
        case 10:
            return CellKind::tetrahedron;
        case 12:
            return CellKind::hexahedron;
        case 13:
            return CellKind::wedge;
        case 14:
            return CellKind::pyramid;
        default:
            return std::nullopt;
    }
}

bool is_flat(std::int64_t type) {
    return type == 1 || type == 3 || type == 5 || type == 9;  // vertex, line, triangle, quadrilateral
}

// The key of a line "KEY= …", the position behind its "=". Empty for any other line, which is skipped.
std::string read_key(TextScanner& scanner) {
    std::string key(scanner.peek());
    const std::size_t equals = key.find('=');
    if (equals != std::string::npos) {
        scanner.skip_past("=");
        return key.substr(0, equals);
    }
    scanner.word("a key");
    if (!scanner.line_at_end() && scanner.peek().starts_with('=')) {
        scanner.skip_past("=");
        return key;
    }
    scanner.rest_of_line();
    return "";
}

void read_cells(TextScanner& scanner, TextCells& cells, std::size_t& skipped) {
    const std::size_t count = scanner.count("the number of elements", 6);  // "3 0 1\n"
    scanner.rest_of_line();
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t type = scanner.integer("the type of an element");
        if (const std::optional<CellKind> kind = volume_kind(type)) {
            cells.read(scanner, *kind, vertex_count(*kind));
        } else if (is_flat(type)) {
            ++skipped;
        } else {
            scanner.fail_word("an element type 10 (tetrahedron), 12 (hexahedron), 13 (wedge), 14 (pyramid)");
        }
        scanner.rest_of_line();  // its own index, if it is there
    }
}

void read_points(TextScanner& scanner, std::vector<glm::dvec3>& points) {
    const std::size_t count = scanner.count("the number of points", 6);
    scanner.rest_of_line();  // the number without ghost points, if it is there
    points.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        points.push_back(read_point(scanner));
        scanner.rest_of_line();
    }
}

void skip_marker(TextScanner& scanner, std::size_t& skipped) {
    const std::size_t count = scanner.count("the number of elements of a marker", 4);  // "1 0\n"
    scanner.rest_of_line();
    for (std::size_t i = 0; i < count; ++i) {
        scanner.integer("the type of an element");
        scanner.rest_of_line();
    }
    skipped += count;
}

void require_number(TextScanner& scanner, std::int64_t only, const std::string& expected, std::string_view advice) {
    if (scanner.integer(expected) != only) scanner.fail_word(expected, advice, ErrorKind::data);
}

// A second list would be that of another zone.
void require_first(bool first, const TextScanner& scanner, const std::string& key) {
    if (!first) scanner.fail("one list " + key + "=", "a second one", "write one zone per file", ErrorKind::data);
}

}  // namespace

Dataset read_su2(const std::filesystem::path& file) {
    TextScanner scanner(file, '%');
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = "SU2 mesh";
    TextCells cells(0);
    bool has_dimension = false, has_cells = false, has_points = false;
    while (!scanner.at_end()) {
        const std::string key = read_key(scanner);
        if (key == "NDIME") {
            require_number(scanner, 3, "the dimension 3", "flat meshes have no volume");
            has_dimension = true;
        } else if (key == "NZONE") {
            require_number(scanner, 1, "one zone", "write one zone per file");
        } else if (key == "NELEM") {
            require_first(!has_cells, scanner, key);
            read_cells(scanner, cells, dataset.skipped_cells);
            has_cells = true;
        } else if (key == "NPOIN") {
            require_first(!has_points, scanner, key);
            read_points(scanner, dataset.points);
            has_points = true;
        } else if (key == "MARKER_ELEMS") {
            skip_marker(scanner, dataset.skipped_cells);
        }
    }
    if (!has_dimension || !has_cells || !has_points) {
        const std::string missing = !has_dimension ? "NDIME=" : !has_cells ? "NELEM=" : "NPOIN=";
        scanner.fail("a line " + missing, "the end of the file",
                     "is it an SU2 mesh? If so, it is cut off or damaged: write or copy it again");
    }
    dataset.cells = cells.take(scanner, dataset.points.size());
    require_volume_mesh(dataset);
    return dataset;
}

}  // namespace cellproj
