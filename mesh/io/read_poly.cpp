// SPDX-License-Identifier: BSD-3-Clause
//
// TetGen 1.5 manual, sections 5.2.2 (.poly) and 5.2.3 (.smesh): points, facets, holes, regions.
#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/dataset.hpp"
#include "mesh/error.hpp"
#include "mesh/io/planar_facet.hpp"
#include "mesh/surface.hpp"
#include "mesh/io/tetgen_nodes.hpp"
#include "mesh/io/text_cells.hpp"
#include "mesh/io/text_scanner.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t column_bytes = tetgen_column_bytes;

bool is_smesh(const fs::path& file) {
    std::string suffix = file.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
    return suffix == ".smesh";
}

// Points in the file itself, or none: then they are in the .node file. Returns the index of the first one.
std::int64_t read_points(TextScanner& scanner, const fs::path& file, Surface& surface) {
    Dataset nodes;
    std::int64_t first = 0;
    if (scanner.peek() == "0") {
        scanner.rest_of_line();
        TextScanner beside(fs::path(file).replace_extension(".node"), '#');
        first = read_tetgen_nodes(beside, nodes);
    } else {
        first = read_tetgen_nodes(scanner, nodes);
    }
    surface.points = std::move(nodes.points);
    for (Field& field : nodes.point_fields) {
        if (field.name != "boundary_marker") surface.point_fields.push_back(std::move(field));
    }
    return first;
}

std::vector<VertexId> read_corners(TextScanner& scanner, std::int64_t first, std::size_t points) {
    const std::size_t count = scanner.count("the number of corners of a polygon", column_bytes);
    if (count < 3) {
        scanner.fail_word("polygons of at least 3 corners",
                          "points and segments within a facet are not supported: leave them out", ErrorKind::data);
    }
    std::vector<VertexId> corners(count);
    for (VertexId& corner : corners) {
        const std::int64_t id = scanner.integer("a corner of a polygon");
        if (id < first || id - first >= static_cast<std::int64_t>(points)) {
            scanner.fail_word("a point from " + std::to_string(first) + " to " +
                                  std::to_string(first + static_cast<std::int64_t>(points) - 1),
                              TextScanner::damaged, ErrorKind::data);
        }
        corner = static_cast<VertexId>(id - first);
    }
    return corners;
}

// An index, which nobody needs, and a place.
glm::dvec3 read_seed(TextScanner& scanner) {
    scanner.integer("an index");
    return read_point(scanner);
}

void add_facet(TextScanner& scanner, const std::vector<std::vector<VertexId>>& polygons,
               const std::vector<glm::dvec3>& holes, Surface& surface) {
    const std::size_t facet = surface.facets.empty() ? 0 : surface.facets.back() + std::size_t{1};
    const auto add = [&](std::vector<VertexId> polygon) {
        surface.polygons.push_back(std::move(polygon));
        surface.facets.push_back(static_cast<std::uint32_t>(facet));
    };
    if (polygons.size() == 1 && holes.empty()) return add(polygons.front());
    const auto triangles = triangulate_facet(surface.points, polygons, holes);
    if (!triangles || triangles->empty()) {
        scanner.fail("polygons of a facet that enclose an area and do not cross each other",
                     "facet " + std::to_string(facet) + ", whose polygons do",
                     "split it into facets of one polygon each; facets count from 0", ErrorKind::data);
    }
    for (const auto& triangle : *triangles)
        add({triangle.begin(), triangle.end()});
}

// .smesh: one polygon per facet, its corners and perhaps a marker in its line.
void read_simple_facet(TextScanner& scanner, std::int64_t first, Surface& surface) {
    const auto polygon = read_corners(scanner, first, surface.points.size());
    scanner.rest_of_line();
    add_facet(scanner, {polygon}, {}, surface);
}

// .poly: the numbers of polygons and holes, then these.
void read_facet(TextScanner& scanner, std::int64_t first, Surface& surface) {
    const std::size_t polygon_count = scanner.count("the number of polygons of a facet", 4 * column_bytes);
    if (polygon_count == 0) scanner.fail_word("at least one polygon of a facet");
    const std::size_t hole_count = optional_tetgen_count(scanner, "the number of holes of a facet");
    scanner.rest_of_line();
    std::vector<std::vector<VertexId>> polygons;
    for (std::size_t i = 0; i < polygon_count; ++i) {
        polygons.push_back(read_corners(scanner, first, surface.points.size()));
        scanner.rest_of_line();
    }
    std::vector<glm::dvec3> holes;
    for (std::size_t i = 0; i < hole_count; ++i)
        holes.push_back(read_seed(scanner));
    add_facet(scanner, polygons, holes, surface);
}

Region read_region(TextScanner& scanner) {
    Region region{read_seed(scanner)};
    region.attribute = scanner.finite("the attribute of a region");
    // TetGen takes a bound that is not positive for none.
    if (!scanner.line_at_end()) region.max_volume = std::max(0.0, scanner.finite("the largest volume in a region"));
    scanner.rest_of_line();
    return region;
}

}  // namespace

Surface read_poly(const fs::path& file) {
    TextScanner scanner(file, '#');
    Surface surface;
    surface.name = file.string();
    surface.inside = Inside::enclosed;
    const std::int64_t first = read_points(scanner, file, surface);

    const std::size_t facets = scanner.count("the number of facets", 4 * column_bytes);
    scanner.rest_of_line();
    const auto read_one = is_smesh(file) ? read_simple_facet : read_facet;
    for (std::size_t i = 0; i < facets; ++i)
        read_one(scanner, first, surface);

    const std::size_t holes = scanner.count("the number of holes", 4 * column_bytes);
    for (std::size_t i = 0; i < holes; ++i)
        surface.holes.push_back(read_seed(scanner));
    const std::size_t regions = scanner.at_end() ? 0 : scanner.count("the number of regions", 5 * column_bytes);
    for (std::size_t i = 0; i < regions; ++i)
        surface.regions.push_back(read_region(scanner));
    validate(surface);
    return surface;
}

}  // namespace cellproj
