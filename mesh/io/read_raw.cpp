// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"
#include "mesh/io/number_file.hpp"
#include "mesh/text_formats.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

std::string to_words(const GridDimensions& n) {
    return std::to_string(n.ni) + " x " + std::to_string(n.nj) + " x " + std::to_string(n.nk);
}

[[noreturn]] void fail(ErrorKind kind, const fs::path& file, const std::string& expected, const std::string& found,
                       const std::string& advice) {
    throw Error({.kind = kind, .place = file.string(), .expected = expected, .found = found, .advice = advice});
}

// The same slices but more or fewer of them, the same numbers of another width, a cube: what `bytes` could be instead.
std::string volumes_that_fit(const RawVolume& raw, std::uint64_t bytes) {
    const GridDimensions& n = raw.dimensions;
    const std::uint64_t width = bytes_of(raw.type);
    std::string list;
    const auto add = [&](const std::string& text) { list += (list.empty() ? "" : ", or ") + text; };
    if (const std::uint64_t slice = n.ni * n.nj * width; bytes % slice == 0 && bytes / slice >= 2) {
        add(to_words({n.ni, n.nj, bytes / slice}) + " of this type");
    }
    for (const std::uint64_t other : {1, 2, 4, 8}) {
        if (other != width && n.ni * n.nj * n.nk * other == bytes) {
            add(to_words(n) + " of a type of " + std::to_string(other) + " bytes");
        }
    }
    for (const std::uint64_t each : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{4}, std::uint64_t{8}}) {
        const auto side = static_cast<std::uint64_t>(std::llround(std::cbrt(static_cast<double>(bytes / each))));
        if (side >= 2 && side * side * side * each == bytes) {
            add(to_words({side, side, side}) + " of a type of " + std::to_string(each) + " bytes");
        }
    }
    return list;
}

void require_sound(const RawVolume& raw, const fs::path& file) {
    const GridDimensions& n = raw.dimensions;
    if (std::min({n.ni, n.nj, n.nk}) < 2) {
        fail(ErrorKind::option, file, "at least 2 points in each direction", to_words(n), "check the dimensions");
    }
    if (std::max({n.ni, n.nj, n.nk}) > max_elements || n.ni * n.nj > max_elements / n.nk) {
        fail(ErrorKind::option, file, "at most " + std::to_string(max_elements) + " points (ids have 32 bits)",
             to_words(n), "cut the volume into parts");
    }
    for (int axis = 0; axis < 3; ++axis) {
        if (std::isfinite(raw.spacing[axis]) && raw.spacing[axis] != 0.0 && std::isfinite(raw.origin[axis])) continue;
        fail(ErrorKind::option, file, "a spacing that is finite and not 0, an origin that is finite",
             std::to_string(raw.spacing[axis]) + " and " + std::to_string(raw.origin[axis]), "check them");
    }
    const std::uint64_t needed = n.ni * n.nj * n.nk * bytes_of(raw.type);
    const std::uint64_t size = fs::file_size(file);
    if (size >= raw.header_bytes && size - raw.header_bytes == needed) return;
    const std::string fits = size > raw.header_bytes ? volumes_that_fit(raw, size - raw.header_bytes) : "";
    const std::string header =
        raw.header_bytes > 0 ? " behind a header of " + std::to_string(raw.header_bytes) : std::string();
    fail(ErrorKind::format, file,
         std::to_string(needed) + " bytes" + header + ", " + to_words(n) + " times " +
             std::to_string(bytes_of(raw.type)),
         "a file of " + std::to_string(size) + " bytes" + (fits.empty() ? "" : ", which fits " + fits),
         size > needed && size - needed != raw.header_bytes
             ? "check dimensions, type and header; a header would take " + std::to_string(size - needed) + " bytes"
             : "check dimensions and type; the file may be cut off");
}

}  // namespace

Dataset read_raw(const fs::path& file, const RawVolume& raw) {
    require_readable(file);
    require_sound(raw, file);
    const GridDimensions& n = raw.dimensions;
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = "raw volume";
    dataset.grid = n;
    dataset.points.reserve(n.ni * n.nj * n.nk);
    for (std::size_t k = 0; k < n.nk; ++k) {
        for (std::size_t j = 0; j < n.nj; ++j) {
            for (std::size_t i = 0; i < n.ni; ++i)
                dataset.points.push_back(raw.origin + glm::dvec3(i, j, k) * raw.spacing);
        }
    }
    dataset.boxes = BoxGrid{{uniform_axis(raw.origin.x, raw.spacing.x, n.ni), uniform_axis(raw.origin.y, raw.spacing.y, n.nj),
                             uniform_axis(raw.origin.z, raw.spacing.z, n.nk)},
                            {}};
    const std::size_t width = bytes_of(raw.type);
    const std::string bytes = read_bytes(file, raw.header_bytes, dataset.points.size() * width);
    if (bytes.size() != dataset.points.size() * width) {
        fail(ErrorKind::file, file, std::to_string(dataset.points.size() * width) + " bytes",
             std::to_string(bytes.size()), "the file changed while it was read: read it again");
    }
    Field values{"value", 1, std::vector<double>(dataset.points.size())};
    for (std::size_t p = 0; p < values.values.size(); ++p)
        values.values[p] = decode_number(bytes.data() + p * width, raw.type, raw.big_endian);
    dataset.point_fields.push_back(std::move(values));
    return dataset;
}

}  // namespace cellproj
