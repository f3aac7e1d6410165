// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/text_cells.hpp"

#include <string>
#include <utility>

namespace cellproj {

void append_cell(CellList& cells, CellKind kind, std::span<const VertexId> corners) {
    if (cells.offsets.empty()) cells.offsets.push_back(0);
    cells.kinds.push_back(kind);
    cells.vertices.insert(cells.vertices.end(), corners.begin(), corners.end());
    cells.offsets.push_back(cells.vertices.size());
}

void reserve_cells(CellList& cells, CellKind kind, std::size_t count) {
    cells.kinds.reserve(cells.kinds.size() + count);
    cells.offsets.reserve(cells.kinds.size() + count + 1);
    cells.vertices.reserve(cells.vertices.size() + count * vertex_count(kind));
}

void TextCells::read(TextScanner& scanner, CellKind kind, std::size_t nodes, std::span<const std::int8_t> places) {
    const std::size_t corners = vertex_count(kind);
    const std::size_t needed = places.empty() ? corners : nodes;
    nodes_.clear();
    for (std::size_t i = 0; i < nodes; ++i) {
        const std::int64_t id = scanner.integer("a vertex id") - first_id_;
        if (id < 0 || id >= static_cast<std::int64_t>(max_elements)) {
            scanner.fail_word("a vertex id from " + std::to_string(first_id_) + " on", TextScanner::damaged,
                              ErrorKind::data);
        }
        if (i >= needed) continue;
        nodes_.push_back(static_cast<VertexId>(id));
        if (nodes_.back() < largest_) continue;
        largest_ = nodes_.back();
        largest_position_ = scanner.position();
    }
    if (!places.empty()) curved_.add(cells_.size(), nodes_, places);
    append_cell(cells_, kind, std::span(nodes_).first(corners));
}

CellList TextCells::take(const TextScanner& scanner, std::size_t points) {
    if (cells_.size() > 0 && largest_ >= points) {
        scanner.fail_at(largest_position_, "a vertex id of one of the " + std::to_string(points) + " points",
                        std::to_string(largest_ + first_id_), "points are missing or the id is wrong: write it again",
                        ErrorKind::data);
    }
    return std::move(cells_);
}

glm::dvec3 read_point(TextScanner& scanner) {
    glm::dvec3 point;
    for (int axis = 0; axis < 3; ++axis)
        point[axis] = scanner.finite("a coordinate");
    return point;
}

void require_volume_mesh(const Dataset& dataset) {
    const auto require = [&](bool good, const std::string& expected, const std::string& found,
                             const std::string& advice) {
        if (good) return;
        throw Error({ErrorKind::data, dataset.source, expected, found, advice});
    };
    const std::string most = "at most " + std::to_string(max_elements);
    const std::size_t points = dataset.points.size(), cells = dataset.cells.size();
    require(points > 0, "points", "none", "was a mesh written into this file?");
    require(cells > 0, "volume cells", "none, and " + std::to_string(dataset.skipped_cells) + " others",
            "write the volume mesh, too, or make one of the surface with a mesher");
    require(points <= max_elements, most + " points", std::to_string(points), "cut the data into parts");
    require(cells <= max_elements, most + " cells", std::to_string(cells), "cut the data into parts");
}

}  // namespace cellproj
