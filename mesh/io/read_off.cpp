// SPDX-License-Identifier: BSD-3-Clause
//
// OFF, as Geomview's manual describes it: a word that ends in OFF, three counts, one line per vertex, one per face.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/surface.hpp"
#include "mesh/text_file.hpp"

namespace cellproj {

namespace {

constexpr std::string_view blanks = " \t\r\f\v";

// The words of a text, line by line; comments and empty lines are passed over.
class Lines {
public:
    Lines(std::string_view text, const std::filesystem::path& file) : text_(text), file_(file) {}

    [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
        throw Error({.kind = ErrorKind::format,
                     .place = file_.string() + ", line " + std::to_string(number_),
                     .expected = expected,
                     .found = found,
                     .advice = "the file may be cut off or damaged: write or copy it again"});
    }

    void next(const std::string& expected) {
        do {
            if (text_.empty()) fail(expected, "the end of the file");
            line_ = text_.substr(0, text_.find('\n'));
            text_.remove_prefix(std::min(line_.size() + 1, text_.size()));
            line_ = line_.substr(0, line_.find('#'));
            ++number_;
        } while (line_.find_first_not_of(blanks) == std::string_view::npos);
    }

    // Empty at the end of the line.
    std::string_view word() {
        line_.remove_prefix(std::min(line_.find_first_not_of(blanks), line_.size()));
        const std::string_view word = line_.substr(0, line_.find_first_of(blanks));
        line_.remove_prefix(word.size());
        return word;
    }

    template <class T>
    T number(const std::string& expected) {
        const std::string_view digits = word();
        std::string_view unsigned_digits = digits;
        if (unsigned_digits.starts_with('+')) unsigned_digits.remove_prefix(1);
        T value{};
        const char* const end = unsigned_digits.data() + unsigned_digits.size();
        const auto [rest, error] = std::from_chars(unsigned_digits.data(), end, value);
        if (error != std::errc() || rest != end || digits.empty()) {
            fail(expected, digits.empty() ? "the end of the line" : "\"" + std::string(digits.substr(0, 40)) + "\"");
        }
        return value;
    }

    bool at_end_of_line() const { return line_.find_first_not_of(blanks) == std::string_view::npos; }
    std::size_t bytes_left() const { return text_.size(); }

private:
    std::string_view text_, line_;
    const std::filesystem::path& file_;
    std::size_t number_ = 0;
};

// Vertices of three coordinates, whatever follows them in their line.
bool is_supported(std::string_view keyword) {
    for (const std::string_view known : {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"}) {
        if (keyword == known) return true;
    }
    return false;
}

std::array<std::uint64_t, 2> read_counts(Lines& lines) {
    lines.next("a word that ends in OFF");
    if (const std::string keyword(lines.word()); !is_supported(keyword)) {
        lines.fail("OFF, COFF or NOFF, in ascii", "\"" + keyword.substr(0, 40) + "\"");
    }
    if (lines.at_end_of_line()) lines.next("the numbers of vertices and faces");
    const auto vertices = lines.number<std::uint64_t>("the number of vertices");
    const auto faces = lines.number<std::uint64_t>("the number of faces");
    // A vertex or a face takes six bytes at least ("0 0 0\n"): counts are checked before memory is asked for.
    if (vertices > lines.bytes_left() / 6 + 1 || faces > lines.bytes_left() / 6 + 1) {
        lines.fail("as many vertices and faces as the file has room for",
                   std::to_string(vertices) + " and " + std::to_string(faces));
    }
    return {vertices, faces};
}

}  // namespace

Surface read_off(const std::filesystem::path& file) {
    const std::string text = read_text_file(file, "a surface file");
    Lines lines(text, file);
    const auto [vertices, faces] = read_counts(lines);
    Surface surface;
    surface.name = file.string();
    for (std::uint64_t i = 0; i < vertices; ++i) {
        lines.next("vertex " + std::to_string(i));
        glm::dvec3& p = surface.points.emplace_back();
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = lines.number<double>("three coordinates");
    }
    for (std::uint64_t i = 0; i < faces; ++i) {
        lines.next("face " + std::to_string(i));
        const auto size = lines.number<std::uint32_t>("the number of vertices of a face");
        std::vector<VertexId>& polygon = surface.polygons.emplace_back();
        for (std::uint32_t k = 0; k < size; ++k)
            polygon.push_back(lines.number<VertexId>("vertex " + std::to_string(k) + " of a face"));
    }
    validate(surface);
    return surface;
}

}  // namespace cellproj
