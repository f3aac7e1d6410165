// SPDX-License-Identifier: BSD-3-Clause
//
// Frey, "MEDIT: An interactive mesh visualization software", INRIA RT-0253, 2001; keywords of second order: libMeshb.
// A file is a list of keywords, each followed by a count and rows of numbers.
#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>

#include "mesh/io/text_cells.hpp"
#include "mesh/text_formats.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// A digit and a blank or line end: the least that a number takes.
constexpr std::size_t number_bytes = 2;

struct VolumeKeyword {
    std::string_view name;
    CellKind kind;
    std::size_t nodes;
};

constexpr std::array volume_keywords{
    VolumeKeyword{"Tetrahedra", CellKind::tetrahedron, 4},
    VolumeKeyword{"Hexahedra", CellKind::hexahedron, 8},
    VolumeKeyword{"Hexaedra", CellKind::hexahedron, 8},  // the spelling of some writers
    VolumeKeyword{"Prisms", CellKind::wedge, 6},
    VolumeKeyword{"Pentahedra", CellKind::wedge, 6},
    VolumeKeyword{"Pyramids", CellKind::pyramid, 5},
    VolumeKeyword{"TetrahedraP2", CellKind::tetrahedron, 10},
    VolumeKeyword{"HexahedraQ2", CellKind::hexahedron, 27},
    VolumeKeyword{"PrismsP2", CellKind::wedge, 18},
    VolumeKeyword{"PyramidsP2", CellKind::pyramid, 14},
};

constexpr std::array<std::string_view, 5> flat_keywords{"Edges", "Triangles", "Quadrilaterals", "EdgesP2",
                                                        "TrianglesP2"};

bool starts_keyword(std::string_view word) {
    return !word.empty() && std::isalpha(static_cast<unsigned char>(word.front())) != 0;
}

void skip_numbers(TextScanner& scanner) {
    while (!scanner.at_end() && !starts_keyword(scanner.peek()))
        scanner.word("a number");
}

void read_header(TextScanner& scanner) {
    if (scanner.word("MeshVersionFormatted") != "MeshVersionFormatted") {
        scanner.fail_word("MeshVersionFormatted",
                          "is it an ascii Medit file? Binary ones (.meshb) are to be converted");
    }
    const std::int64_t version = scanner.integer("a version");
    if (version < 1 || version > 4) scanner.fail_word("a version from 1 to 4");
}

void require_three_dimensions(TextScanner& scanner) {
    if (scanner.integer("the dimension") == 3) return;
    scanner.fail_word("the dimension 3", "flat meshes have no volume", ErrorKind::data);
}

[[noreturn]] void fail_without_end(const TextScanner& scanner) {
    scanner.fail("the keyword End", "the end of the file",
                 "the file is cut off: write or copy it again, or add a line \"End\" if it is complete");
}

void read_vertices(TextScanner& scanner, std::vector<glm::dvec3>& points) {
    if (!points.empty()) scanner.fail("one list of vertices", "a second one");
    const std::size_t count = scanner.count("the number of vertices", 4 * number_bytes);
    points.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        points.push_back(read_point(scanner));
        scanner.number("the reference of a vertex");
    }
}

void read_cells(TextScanner& scanner, const VolumeKeyword& keyword, TextCells& cells, std::vector<double>& regions) {
    const std::size_t count = scanner.count("the number of cells", (keyword.nodes + 1) * number_bytes);
    cells.reserve(keyword.kind, count);
    regions.reserve(regions.size() + count);
    for (std::size_t i = 0; i < count; ++i) {
        cells.read(scanner, keyword.kind, keyword.nodes);
        regions.push_back(static_cast<double>(scanner.integer("the reference of a cell")));
    }
}

Dataset read_mesh(const fs::path& file) {
    TextScanner scanner(file, '#');
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = "Medit mesh";
    read_header(scanner);
    TextCells cells(1);
    Field regions{"region", 1, {}};
    for (std::string_view keyword; keyword != "End";) {
        if (scanner.at_end()) fail_without_end(scanner);
        keyword = scanner.word("a keyword");
        const auto* const volume = std::find_if(volume_keywords.begin(), volume_keywords.end(),
                                                [&](const VolumeKeyword& known) { return known.name == keyword; });
        if (volume != volume_keywords.end()) {
            read_cells(scanner, *volume, cells, regions.values);
        } else if (keyword == "Dimension") {
            require_three_dimensions(scanner);
        } else if (keyword == "Vertices") {
            read_vertices(scanner, dataset.points);
        } else if (std::find(flat_keywords.begin(), flat_keywords.end(), keyword) != flat_keywords.end()) {
            dataset.skipped_cells += scanner.count("the number of cells", number_bytes);
            skip_numbers(scanner);
        } else if (starts_keyword(keyword)) {
            if (keyword != "End") skip_numbers(scanner);  // corners, ridges, normals, …: nothing to draw
        } else {
            scanner.fail_word("a keyword");
        }
    }
    dataset.cells = cells.take(scanner, dataset.points.size());
    dataset.cell_fields.push_back(std::move(regions));
    require_volume_mesh(dataset);
    return dataset;
}

// ---- Solutions ----

// Components of a solution of this type in three dimensions.
int components(TextScanner& scanner) {
    switch (scanner.integer("the type of a solution")) {
        case 1:
            return 1;
        case 2:
            return 3;
        case 3:
            return 6;
        case 4:
            return 9;
        default:
            scanner.fail_word("a solution type 1 (scalar), 2 (vector), 3 (symmetric tensor) or 4 (tensor)");
    }
}

std::vector<Field> read_solution_list(TextScanner& scanner, std::size_t points) {
    const std::size_t rows = scanner.count("the number of rows", number_bytes);
    if (rows != points) {
        scanner.fail_word("a row for each of the " + std::to_string(points) + " vertices",
                          "mesh and solution do not belong together: rename or remove the .sol file", ErrorKind::data);
    }
    const std::size_t count = scanner.count("the number of solutions", number_bytes);
    std::vector<Field> fields;
    std::size_t row_bytes = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string name = count == 1 ? "solution" : "solution_" + std::to_string(i + 1);
        fields.push_back({name, components(scanner), {}});
        row_bytes += static_cast<std::size_t>(fields.back().components) * number_bytes;
    }
    if (count > 0) scanner.require_room(rows, row_bytes, "a number of rows");
    for (Field& field : fields)
        field.values.reserve(rows * static_cast<std::size_t>(field.components));
    for (std::size_t row = 0; row < rows; ++row) {
        for (Field& field : fields) {
            for (int c = 0; c < field.components; ++c)
                field.values.push_back(scanner.number("a value of a solution"));
        }
    }
    return fields;
}

std::vector<Field> read_solutions(const fs::path& file, std::size_t points) {
    TextScanner scanner(file, '#');
    read_header(scanner);
    for (;;) {
        if (scanner.at_end()) fail_without_end(scanner);
        const std::string_view keyword = scanner.word("a keyword");
        if (keyword == "SolAtVertices") return read_solution_list(scanner, points);
        if (keyword == "End") return {};
        if (keyword == "Dimension") {
            require_three_dimensions(scanner);
        } else if (starts_keyword(keyword)) {
            skip_numbers(scanner);  // solutions at cells, times, …
        } else {
            scanner.fail_word("a keyword");
        }
    }
}

}  // namespace

Dataset read_medit(const fs::path& file) {
    Dataset dataset = read_mesh(file);
    const fs::path solutions = fs::path(file).replace_extension(".sol");
    if (fs::exists(solutions)) dataset.point_fields = read_solutions(solutions, dataset.points.size());
    return dataset;
}

}  // namespace cellproj
