// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

#include "mesh/error.hpp"
#include "mesh/io/vtk_conversion.hpp"

namespace cellproj {

namespace {

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// Integers one after the other: text, or 4 bytes each, most significant first.
class IntegerReader {
public:
    IntegerReader(std::string_view bytes, bool binary) : bytes_(bytes), binary_(binary) {}

    std::optional<std::int64_t> next() { return binary_ ? next_binary() : next_text(); }

private:
    std::optional<std::int64_t> next_text() {
        while (!bytes_.empty() && is_space(bytes_.front()))
            bytes_.remove_prefix(1);
        std::int64_t value = 0;
        const auto [end, error] = std::from_chars(bytes_.data(), bytes_.data() + bytes_.size(), value);
        if (error != std::errc()) return std::nullopt;
        bytes_.remove_prefix(static_cast<std::size_t>(end - bytes_.data()));
        return value;
    }

    std::optional<std::int64_t> next_binary() {
        if (bytes_.size() < 4) return std::nullopt;
        std::uint32_t value = 0;
        for (const char byte : bytes_.substr(0, 4))
            value = value << 8U | static_cast<unsigned char>(byte);
        bytes_.remove_prefix(4);
        return static_cast<std::int32_t>(value);
    }

    std::string_view bytes_;
    bool binary_;
};

// Do `cells` groups "count id id ..." make `size` integers?
bool counts_add_up(IntegerReader integers, std::int64_t cells, std::int64_t size) {
    std::int64_t left = size;
    for (std::int64_t c = 0; c < cells; ++c) {
        const auto count = integers.next();
        if (!count || *count < 0 || *count >= left) return false;
        left -= 1 + *count;
        for (std::int64_t v = 0; v < *count; ++v) {
            if (!integers.next()) return false;
        }
    }
    return left == 0;
}

// Where the third line starts, ASCII or BINARY; the first two are the version and a title of any text.
std::size_t encoding_line(std::string_view bytes) {
    const std::size_t version_end = std::min(bytes.find('\n'), bytes.size());
    const std::size_t title_end = std::min(bytes.find('\n', version_end + 1), bytes.size() - 1);
    return title_end + 1;
}

}  // namespace

void require_sound_legacy_cells(const std::filesystem::path& file) {
    const std::string content = read_bytes(file, 0, std::filesystem::file_size(file));
    const std::string_view bytes(content);
    const std::size_t encoding = encoding_line(bytes);
    const bool binary = bytes.substr(encoding).starts_with('B') || bytes.substr(encoding).starts_with('b');
    const std::size_t upper = bytes.find("\nCELLS", encoding);
    const std::size_t keyword = upper != std::string_view::npos ? upper : bytes.find("\ncells", encoding);
    if (keyword == std::string_view::npos) return;
    const std::size_t line = keyword + 1;
    const std::size_t line_end = std::min(bytes.find('\n', line), bytes.size() - 1);
    const std::string_view block = bytes.substr(line_end + 1);
    // From version 5 on, offsets and ids are two arrays, which the reader leaves to be checked afterwards.
    if (bytes.starts_with("# vtk DataFile Version 5.") && block.starts_with("OFFSETS")) return;
    IntegerReader header(bytes.substr(line + 5, line_end - line - 5), false);
    const auto cells = header.next();
    const auto size = header.next();
    if (cells && size && *cells >= 0 && counts_add_up({block, binary}, *cells, *size)) return;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string() + ", the block CELLS at byte " + std::to_string(line),
                 .expected = "groups of a vertex count and as many point ids that fill the stated size",
                 .found = "counts that do not fit",
                 .advice = "the file may be cut off or damaged: write or copy it again"});
}

}  // namespace cellproj
