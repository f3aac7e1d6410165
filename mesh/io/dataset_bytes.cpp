// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/dataset_bytes.hpp"

namespace cellproj {

namespace {

template <class T>
void put_and_free(ByteWriter& writer, std::vector<T>& numbers) {
    writer.array(numbers);
    std::vector<T>().swap(numbers);
}

void put_fields(ByteWriter& writer, std::vector<Field>& fields) {
    writer.value(std::uint64_t{fields.size()});
    for (Field& field : fields) {
        writer.text(field.name);
        writer.value(field.components);
        put_and_free(writer, field.values);
    }
}

std::vector<Field> take_fields(ByteReader& reader) {
    std::vector<Field> fields;
    for (auto left = reader.value<std::uint64_t>("number of fields"); left > 0; --left) {
        Field& field = fields.emplace_back();
        field.name = reader.text("field name");
        field.components = reader.value<int>("components");
        field.values = reader.array<double>("field values");
    }
    return fields;
}

template <class T>
void put_optional(ByteWriter& writer, const std::optional<T>& number) {
    writer.array(number ? std::vector<T>{*number} : std::vector<T>{});
}

template <class T>
std::optional<T> take_optional(ByteReader& reader, const char* what) {
    const std::vector<T> numbers = reader.array<T>(what);
    return numbers.empty() ? std::nullopt : std::optional<T>(numbers.front());
}

void put_boxes(ByteWriter& writer, BoxGrid& boxes) {
    for (const GridAxis& axis : boxes.axes) {
        writer.array(axis.coordinates);
        put_optional(writer, axis.spacing);
    }
    put_and_free(writer, boxes.blanked);
}

BoxGrid take_boxes(ByteReader& reader) {
    BoxGrid boxes;
    for (GridAxis& axis : boxes.axes) {
        axis.coordinates = reader.array<double>("axis");
        axis.spacing = take_optional<double>(reader, "spacing");
    }
    boxes.blanked = reader.array<std::uint8_t>("blanked cells");
    return boxes;
}

void put_pieces(ByteWriter& writer, std::vector<PieceRows>& pieces) {
    writer.value(std::uint64_t{pieces.size()});
    for (PieceRows& piece : pieces) {
        writer.text(piece.name);
        put_boxes(writer, piece.boxes);
        writer.value(piece.points);
        writer.value(piece.cells);
    }
}

std::vector<PieceRows> take_pieces(ByteReader& reader) {
    std::vector<PieceRows> pieces;
    for (auto left = reader.value<std::uint64_t>("number of pieces"); left > 0; --left) {
        PieceRows& piece = pieces.emplace_back();
        piece.name = reader.text("name of a piece");
        piece.boxes = take_boxes(reader);
        piece.points = reader.value<std::size_t>("points of a piece");
        piece.cells = reader.value<std::size_t>("cells of a piece");
    }
    return pieces;
}

}  // namespace

void put(ByteWriter& writer, Dataset&& dataset) {
    writer.text(dataset.source);
    writer.text(dataset.format);
    put_and_free(writer, dataset.points);
    put_optional(writer, dataset.grid);
    put_and_free(writer, dataset.cells.kinds);
    put_and_free(writer, dataset.cells.offsets);
    put_and_free(writer, dataset.cells.vertices);
    writer.value(dataset.boxes.has_value());
    if (dataset.boxes) put_boxes(writer, *dataset.boxes);
    put_pieces(writer, dataset.pieces);
    put_fields(writer, dataset.point_fields);
    put_fields(writer, dataset.cell_fields);
    writer.value(dataset.skipped_cells);
    writer.value(dataset.ghost_cells);
    writer.value(std::uint64_t{dataset.blocks.size()});
    for (const std::string& name : dataset.blocks)
        writer.text(name);
    writer.value(dataset.skipped_blocks);
    writer.array(dataset.times);
    put_optional(writer, dataset.time);
}

void take(ByteReader& reader, Dataset& dataset) {
    dataset.source = reader.text("source");
    dataset.format = reader.text("format");
    dataset.points = reader.array<glm::dvec3>("points");
    dataset.grid = take_optional<GridDimensions>(reader, "grid");
    dataset.cells.kinds = reader.array<CellKind>("kinds");
    dataset.cells.offsets = reader.array<std::uint64_t>("offsets");
    dataset.cells.vertices = reader.array<VertexId>("vertices");
    if (reader.value<bool>("whether there is a grid of boxes")) dataset.boxes = take_boxes(reader);
    dataset.pieces = take_pieces(reader);
    dataset.point_fields = take_fields(reader);
    dataset.cell_fields = take_fields(reader);
    dataset.skipped_cells = reader.value<std::size_t>("skipped cells");
    dataset.ghost_cells = reader.value<std::size_t>("ghost cells");
    for (auto left = reader.value<std::uint64_t>("number of blocks"); left > 0; --left)
        dataset.blocks.push_back(reader.text("block name"));
    dataset.skipped_blocks = reader.value<std::size_t>("skipped blocks");
    dataset.times = reader.array<double>("times");
    dataset.time = take_optional<double>(reader, "time");
}

void put(ByteWriter& writer, Surface&& surface) {
    writer.text(surface.name);
    put_and_free(writer, surface.points);
    writer.lists(surface.polygons);
    writer.array(surface.facets);
    writer.array(surface.holes);
    writer.array(surface.regions);
    writer.value(surface.inside);
    put_fields(writer, surface.point_fields);
}

void take(ByteReader& reader, Surface& surface) {
    surface.name = reader.text("name");
    surface.points = reader.array<glm::dvec3>("points");
    surface.polygons = reader.lists<VertexId>("polygons");
    surface.facets = reader.array<std::uint32_t>("facets");
    surface.holes = reader.array<glm::dvec3>("holes");
    surface.regions = reader.array<Region>("regions");
    surface.inside = reader.value<Inside>("what is inside");
    surface.point_fields = take_fields(reader);
}

void put(ByteWriter& writer, const Error& error) {
    writer.value(error.kind());
    for (const std::string& part : {error.place(), error.expected(), error.found(), error.advice()})
        writer.text(part);
}

Error take_error(ByteReader& reader) {
    ErrorParts parts{};
    parts.kind = reader.value<ErrorKind>("kind");
    for (std::string* part : {&parts.place, &parts.expected, &parts.found, &parts.advice})
        *part = reader.text("error");
    return Error(parts);
}

}  // namespace cellproj
