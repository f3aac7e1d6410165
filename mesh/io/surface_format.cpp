// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/surface_format.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <string>
#include <utility>

#include "mesh/io/file_bytes.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t head_size = 4096;
constexpr std::uint64_t stl_header = 84, stl_facet = 50;  // bytes of a binary STL

std::string lower_suffix(const fs::path& file) {
    std::string suffix = file.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
    return suffix;
}

// The first line that is neither empty nor a comment.
std::string_view first_line(std::string_view head) {
    while (!head.empty()) {
        std::string_view line = head.substr(0, head.find('\n'));
        head.remove_prefix(std::min(line.size() + 1, head.size()));
        line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
        if (!line.empty() && line.front() != '#') return line;
    }
    return {};
}

std::optional<SurfaceFormat> format_by_suffix(const fs::path& file) {
    static constexpr std::array<std::pair<std::string_view, SurfaceFormat>, 5> known{
        {{".stl", SurfaceFormat::stl_binary},
         {".obj", SurfaceFormat::obj},
         {".off", SurfaceFormat::off},
         {".poly", SurfaceFormat::poly},
         {".smesh", SurfaceFormat::smesh}}};
    const std::string suffix = lower_suffix(file);
    for (const auto& [known_suffix, format] : known) {
        if (suffix == known_suffix) return format;
    }
    return std::nullopt;
}

}  // namespace

const char* name(SurfaceFormat format) {
    switch (format) {
        case SurfaceFormat::stl_ascii:
            return "ascii STL";
        case SurfaceFormat::stl_binary:
            return "binary STL";
        case SurfaceFormat::off:
            return "OFF";
        case SurfaceFormat::ply:
            return "PLY";
        case SurfaceFormat::obj:
            return "OBJ";
        case SurfaceFormat::vtp:
            return "VTK XML polygonal data";
        case SurfaceFormat::poly:
            return "TetGen .poly";
        case SurfaceFormat::smesh:
            return "TetGen .smesh";
    }
    return "unknown";
}

std::uint64_t announced_stl_size(std::string_view head) {
    std::uint32_t facets = 0;
    if (head.size() < stl_header) return 0;
    std::memcpy(&facets, head.data() + stl_header - sizeof(facets), sizeof(facets));
    return stl_header + stl_facet * facets;
}

std::optional<SurfaceFormat> detect_surface_format(const fs::path& file) {
    if (!fs::is_regular_file(file)) return std::nullopt;
    const std::string head = read_bytes(file, 0, head_size);
    const std::string_view line = first_line(head);
    const std::string_view word = line.substr(0, line.find_first_of(" \t\r"));
    // Many programs begin the free text of a binary STL with "solid", too: the size tells.
    if (!head.empty() && announced_stl_size(head) == fs::file_size(file)) return SurfaceFormat::stl_binary;
    if (head.starts_with("ply")) return SurfaceFormat::ply;
    if (head.find("<VTKFile") != std::string::npos) {
        const bool is_surface = head.find("\"PolyData\"") != std::string::npos;
        return is_surface ? std::optional(SurfaceFormat::vtp) : std::nullopt;
    }
    if (word.ends_with("OFF")) return SurfaceFormat::off;
    if (word == "solid") return SurfaceFormat::stl_ascii;
    return format_by_suffix(file);
}

}  // namespace cellproj
