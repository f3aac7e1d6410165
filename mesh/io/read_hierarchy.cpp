// SPDX-License-Identifier: BSD-3-Clause
//
// Hierarchies of grids from a JSON file that names their pieces (mesh/README.md).
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "mesh/error.hpp"
#include "mesh/io/file_format.hpp"
#include "mesh/io/assemble_pieces.hpp"
#include "mesh/text_file.hpp"
#include "mesh/text_formats.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& place, const std::string& expected, const std::string& found,
                       const std::string& advice, ErrorKind kind = ErrorKind::format) {
    throw Error({.kind = kind, .place = place, .expected = expected, .found = found, .advice = advice});
}

std::string shown(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 60); }

std::vector<std::string> keys_of(const Json& object) {
    std::vector<std::string> keys;
    for (const auto& item : object.items()) keys.push_back(item.key());
    return keys;
}

glm::dvec3 vector_of(const Json& value, const std::string& place) {
    const bool good = value.is_array() && value.size() == 3 && std::all_of(value.begin(), value.end(), [](const Json& x) { return x.is_number(); });
    if (!good) fail(place, "an array of three numbers", shown(value), "correct it");
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

std::uint64_t count_of(const Json& value, const std::string& place) {
    if (!value.is_number_unsigned()) fail(place, "a whole number, 0 or more", shown(value), "correct it");
    return value.get<std::uint64_t>();
}

NumberType type_of(const Json& value, const std::string& place) {
    std::vector<std::string> known;
    for (const NamedNumberType& named : number_types) {
        if (value.is_string() && value.get<std::string>() == named.name) return named.type;
        known.emplace_back(named.name);
    }
    fail(place, "int8, uint8, int16, uint16, int32, uint32, float32 or float64", shown(value),
         value.is_string() ? "did you mean \"" + nearest_name(value.get<std::string>(), known) + "\"?" : "name the type");
}

// Bare voxels: what --dims and its companions say on the command line.
RawVolume raw_of(const Json& piece, const std::string& place) {
    RawVolume raw;
    const Json& dims = piece.at("dims");
    if (!dims.is_array() || dims.size() != 3) fail(place + ", dims", "three numbers of voxels", shown(dims), "correct it");
    raw.dimensions = {count_of(dims[0], place + ", dims"), count_of(dims[1], place + ", dims"), count_of(dims[2], place + ", dims")};
    if (!piece.contains("type")) fail(place, "the key \"type\" beside \"dims\"", "none", "name the type of the voxels");
    raw.type = type_of(piece.at("type"), place + ", type");
    if (piece.contains("big_endian")) {
        if (!piece.at("big_endian").is_boolean()) fail(place + ", big_endian", "true or false", shown(piece.at("big_endian")), "correct it");
        raw.big_endian = piece.at("big_endian").get<bool>();
    }
    if (piece.contains("spacing")) raw.spacing = vector_of(piece.at("spacing"), place + ", spacing");
    if (piece.contains("origin")) raw.origin = vector_of(piece.at("origin"), place + ", origin");
    if (piece.contains("header")) raw.header_bytes = count_of(piece.at("header"), place + ", header");
    return raw;
}

struct PieceFile {
    std::string name;  // as written
    std::optional<RawVolume> raw;
};

PieceFile piece_of(const Json& piece, const std::string& place) {
    if (piece.is_string()) return {piece.get<std::string>(), std::nullopt};
    if (!piece.is_object() || !piece.contains("file") || !piece.at("file").is_string())
        fail(place, "the name of a file, or {\"file\": NAME, …}", shown(piece), "name the file of the piece");
    const bool raw = piece.contains("dims");
    const std::vector<std::string> known =
        raw ? std::vector<std::string>{"file", "dims", "type", "big_endian", "spacing", "origin", "header"} : std::vector<std::string>{"file", "dims"};
    require_known_keys(place, keys_of(piece), known);
    return {piece.at("file").get<std::string>(), raw ? std::optional(raw_of(piece, place)) : std::nullopt};
}

std::vector<PieceFile> pieces_of(const fs::path& file) {
    const std::string text = read_text_file(file, "a hierarchy of grids");
    Json document;
    try {
        document = Json::parse(text);
    } catch (const Json::exception& error) {
        fail(file.string(), "JSON", error.what(), "check quotes, commas and brackets there");
    }
    if (!document.is_object()) fail(file.string(), "{\"pieces\": […]}", shown(document), "name the pieces");
    require_known_keys(file.string(), keys_of(document), std::vector<std::string>{"pieces"});
    if (!document.contains("pieces") || !document.at("pieces").is_array() || document.at("pieces").empty())
        fail(file.string() + ", pieces", "an array of files", document.contains("pieces") ? shown(document.at("pieces")) : "none", "name the pieces");
    std::vector<PieceFile> pieces;
    for (const Json& piece : document.at("pieces"))
        pieces.push_back(piece_of(piece, file.string() + ", pieces[" + std::to_string(pieces.size()) + "]"));
    return pieces;
}

}  // namespace

Dataset read_hierarchy(const fs::path& file, const ReadOptions& options) {
    std::vector<Dataset> pieces;
    std::vector<std::string> names;
    const std::vector<PieceFile> files = pieces_of(file);
    for (const PieceFile& piece : files) {
        const fs::path path = file.parent_path() / piece.name;
        if (!fs::exists(path)) {
            fail(file.string() + ", the file " + path.string(), "a file", "none of that name", "put it there, or name the right one",
                 ErrorKind::file);
        }
        if (!piece.raw && detect_format(path) == FileFormat::hierarchy)
            fail(file.string() + ", piece " + piece.name, "a file of one grid", "a hierarchy", "name its pieces here");
        ReadOptions how;
        how.raw = piece.raw;
        if (options.progress) {
            how.progress = [&](double fraction) { options.progress((static_cast<double>(pieces.size()) + fraction) / static_cast<double>(files.size())); };
        }
        pieces.push_back(read(path, how));
        names.push_back(piece.name);
    }
    Dataset all = assemble_pieces(std::move(pieces), std::move(names), file.string());
    all.format = "hierarchy of grids, " + all.format;
    return all;
}

}  // namespace cellproj
