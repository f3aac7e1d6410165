// SPDX-License-Identifier: BSD-3-Clause
//
// What the fuzz targets share: bytes become files, and of all exceptions a reader may throw Error only.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "mesh/dataset.hpp"
#include "mesh/error.hpp"
#include "mesh/surface.hpp"

namespace cellproj {

// A file of this process alone.
inline std::filesystem::path fuzz_file(const std::string& suffix) {
    return std::filesystem::temp_directory_path() / ("cellproj_fuzz_" + std::to_string(getpid()) + suffix);
}

inline void write_fuzz_file(const std::string& suffix, std::string_view bytes) {
    std::ofstream(fuzz_file(suffix), std::ios::binary) << bytes;
}

// Every id of a cell and every field must fit the points and cells: whoever reads further trusts them.
inline void require_consistent(const Dataset& dataset) {
    bool good = dataset.cells.offsets.size() == dataset.cells.size() + 1;
    good = good && dataset.cells.offsets.back() == dataset.cells.vertices.size();
    for (const VertexId vertex : dataset.cells.vertices)
        good = good && vertex < dataset.points.size();
    for (const Field& field : dataset.point_fields) {
        good = good && field.values.size() == dataset.points.size() * static_cast<std::size_t>(field.components);
    }
    for (const Field& field : dataset.cell_fields) {
        good = good && field.values.size() == dataset.cells.size() * static_cast<std::size_t>(field.components);
    }
    if (!good) __builtin_trap();
}

// Surfaces say themselves what holds of them.
inline void require_consistent(const Surface& surface) {
    try {
        validate(surface);
    } catch (const Error&) {
        __builtin_trap();
    }
}

// A reader is a function from a path to a Dataset or a Surface.
template <class Reader>
int fuzz(Reader reader, const std::string& suffix) {
    try {
        require_consistent(reader(fuzz_file(suffix)));
    } catch (const Error&) {
        return 0;
    }
    return 0;
}

// One input as one file.
template <class Reader>
int fuzz_one_file(Reader reader, const std::string& suffix, const std::uint8_t* bytes, std::size_t size) {
    write_fuzz_file(suffix, {reinterpret_cast<const char*>(bytes), size});
    return fuzz(reader, suffix);
}

// One input as two files of one stem, the second one behind the first zero byte.
template <class Reader>
int fuzz_two_files(Reader reader, const std::string& first, const std::string& second, const std::uint8_t* bytes,
                   std::size_t size) {
    const std::string_view input(reinterpret_cast<const char*>(bytes), size);
    const std::size_t cut = std::min(input.find('\0'), size);
    write_fuzz_file(first, input.substr(0, cut));
    if (cut < size) {
        write_fuzz_file(second, input.substr(cut + 1));
    } else {
        std::filesystem::remove(fuzz_file(second));
    }
    return fuzz(reader, first);
}

}  // namespace cellproj
