// SPDX-License-Identifier: BSD-3-Clause
//
// Whether the field files of an OpenFOAM case have their ends: VTK's reader passes over a field whose file is cut off.
#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t head_size = 4096;
constexpr std::string_view blanks = " \t\r\n";

std::string_view without_last_blanks(std::string_view text) {
    return text.substr(0, text.find_last_not_of(blanks) + 1);
}

// The last letter that belongs to no comment line; 0 when there is none.
char last_letter(std::string_view tail) {
    tail = without_last_blanks(tail);
    while (!tail.empty()) {
        const std::size_t line = tail.rfind('\n') + 1;  // 0 in the first line, as npos + 1 is
        const std::string_view words = tail.substr(std::min(tail.find_first_not_of(blanks, line), tail.size()));
        if (!words.starts_with("//")) return tail.back();
        tail = without_last_blanks(tail.substr(0, line));
    }
    return 0;
}

// The value of `class` in the header; empty where there is none.
std::string_view class_in(std::string_view header) {
    const std::size_t word = header.find("class");
    if (word == std::string_view::npos) return {};
    const std::size_t begin = std::min(header.find_first_not_of(blanks, word + 5), header.size());
    return header.substr(begin, header.find(';', begin) - begin);
}

// Files that are none of OpenFOAM's count as whole. A field is a dictionary, and its last entry, boundaryField, is one,
// too.
bool is_whole(const fs::path& file) {
    const std::uintmax_t size = fs::file_size(file);
    const std::string head = read_bytes(file, 0, head_size);
    const std::size_t start = head.find("FoamFile");
    if (start == std::string::npos) return !head.empty() && !head.starts_with("/*");
    const std::size_t end = head.find('}', start);
    if (end == std::string::npos) return false;
    const std::string_view kind = class_in(std::string_view(head).substr(start, end - start));
    if (!kind.starts_with("vol") && !kind.starts_with("point")) return true;
    return last_letter(read_bytes(file, size - std::min<std::uintmax_t>(size, head_size), head_size)) == '}';
}

void require_whole_files(const fs::path& folder, const fs::path& entry) {
    std::error_code none;
    for (const auto& file : fs::directory_iterator(folder, none)) {
        if (!file.is_regular_file(none) || file.path().has_extension() || is_whole(file.path())) continue;
        throw Error({.kind = ErrorKind::format,
                     .place = entry.string() + ", " + file.path().string(),
                     .expected = "a field with its end, a closing brace",
                     .found = "a file that is cut off",
                     .advice = "write or copy it again, or remove it"});
    }
}

}  // namespace

void require_whole_openfoam_fields(const fs::path& folder, double time, const fs::path& entry) {
    std::error_code none;
    for (const auto& inside : fs::directory_iterator(folder, none)) {
        if (!inside.is_directory(none)) continue;
        const std::string name = inside.path().filename().string();
        char* end = nullptr;
        if (std::strtod(name.c_str(), &end) != time || end == name.c_str() || *end != 0) continue;
        require_whole_files(inside.path(), entry);
        for (const auto& region : fs::directory_iterator(inside.path(), none)) {
            const bool has_mesh = fs::exists(folder / "constant" / region.path().filename() / "polyMesh", none);
            if (has_mesh && region.is_directory(none)) require_whole_files(region.path(), entry);
        }
    }
}

}  // namespace cellproj
