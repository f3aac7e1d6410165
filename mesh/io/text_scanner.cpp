// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/text_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "mesh/io/file_bytes.hpp"

namespace cellproj {

namespace {

bool is_blank(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

std::string quoted(std::string_view word) {
    constexpr std::size_t longest = 40;
    return '"' + printable(std::string(word.substr(0, longest))) + (word.size() > longest ? "..." : "") + '"';
}

std::string whole(const std::filesystem::path& file) {
    require_readable(file);
    const std::uintmax_t size = std::filesystem::file_size(file);
    std::string bytes = read_bytes(file, 0, size);
    if (bytes.size() == size) return bytes;
    throw Error({.kind = ErrorKind::file,
                 .place = file.string() + ", byte " + std::to_string(bytes.size()),
                 .expected = std::to_string(size) + " bytes",
                 .found = "a read error",
                 .advice = "check the disk, and that nothing writes the file"});
}

}  // namespace

TextScanner::TextScanner(const std::filesystem::path& file, char comment)
    : file_(file.string()), text_(whole(file)), comment_(comment) {}

bool TextScanner::ends_word(std::size_t position) const {
    return position >= text_.size() || is_blank(text_[position]) || (comment_ != '\0' && text_[position] == comment_);
}

void TextScanner::skip_blanks() {
    while (position_ < text_.size() && ends_word(position_)) {
        if (is_blank(text_[position_])) {
            ++position_;
        } else {
            position_ = std::min(text_.find('\n', position_), text_.size());
        }
    }
    mark();
}

bool TextScanner::at_end() {
    skip_blanks();
    return position_ == text_.size();
}

std::string_view TextScanner::peek() {
    skip_blanks();
    std::size_t end = position_;
    while (!ends_word(end))
        ++end;
    return std::string_view(text_).substr(position_, end - position_);
}

std::string_view TextScanner::word(std::string_view what) {
    const std::string_view next = peek();
    if (next.empty()) fail(what, "the end of the file", cut_off);
    position_ += next.size();
    return next;
}

template <class Number>
Number TextScanner::parse(std::string_view what) {
    skip_blanks();
    const char* const end = text_.data() + text_.size();
    const char* begin = text_.data() + position_;
    if (begin != end && *begin == '+') ++begin;
    Number value{};
    const auto [stop, error] = std::from_chars(begin, end, value);
    const auto stop_position = static_cast<std::size_t>(stop - text_.data());
    if (error != std::errc() || !ends_word(stop_position)) fail_word(what);
    position_ = stop_position;
    return value;
}

double TextScanner::number(std::string_view what) {
    return parse<double>(what);
}

double TextScanner::finite(std::string_view what) {
    const double value = parse<double>(what);
    if (!std::isfinite(value)) {
        fail_word(std::string(what) + " that is finite",
                  "look for the program that wrote it: no cell can be drawn there", ErrorKind::data);
    }
    return value;
}

std::int64_t TextScanner::integer(std::string_view what) {
    return parse<std::int64_t>(what);
}

std::size_t TextScanner::count(std::string_view what, std::size_t bytes_each) {
    const std::int64_t things = parse<std::int64_t>(what);
    if (things < 0) fail_word(std::string(what) + ", 0 or more");
    require_room(static_cast<std::uint64_t>(things), bytes_each, what);
    return static_cast<std::size_t>(things);
}

void TextScanner::require_room(std::uint64_t things, std::size_t bytes_each, std::string_view what) {
    // The last blank may be missing at the end of a file.
    if (things <= (remaining() + 1) / bytes_each) return;
    fail(std::string(what) + " that fits the rest of the file, " + std::to_string(remaining()) + " bytes",
         std::to_string(things) + ", at least " + std::to_string(bytes_each) + " bytes each",
         "the file is cut off or damaged: write or copy it again");
}

bool TextScanner::line_at_end() {
    while (position_ < text_.size() && text_[position_] != '\n' && is_blank(text_[position_]))
        ++position_;
    return position_ == text_.size() || text_[position_] == '\n' || (comment_ != '\0' && text_[position_] == comment_);
}

std::string_view TextScanner::rest_of_line() {
    mark();
    const std::size_t end = std::min(text_.find('\n', position_), text_.size());
    std::string_view line = std::string_view(text_).substr(position_, end - position_);
    if (comment_ != '\0') line = line.substr(0, line.find(comment_));
    while (!line.empty() && is_blank(line.back()))
        line.remove_suffix(1);
    position_ = std::min(end + 1, text_.size());
    return line;
}

void TextScanner::skip_past(std::string_view marker) {
    const std::size_t found = text_.find(marker, position_);
    if (found == std::string::npos) {
        fail_at(text_.size(), marker, "the end of the file", cut_off, ErrorKind::format);
    }
    position_ = found + marker.size();
}

void TextScanner::fail(std::string_view expected, std::string_view found, std::string_view advice,
                       ErrorKind kind) const {
    fail_at(last_, expected, found, advice, kind);
}

void TextScanner::fail_word(std::string_view expected, std::string_view advice, ErrorKind kind) const {
    std::size_t end = last_;
    while (!ends_word(end))
        ++end;
    if (end == text_.size() && end == last_) fail(expected, "the end of the file", cut_off);
    fail(expected, quoted(std::string_view(text_).substr(last_, end - last_)), advice, kind);
}

void TextScanner::fail_at(std::size_t position, std::string_view expected, std::string_view found,
                          std::string_view advice, ErrorKind kind) const {
    const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(position), '\n') + 1;
    const std::string where = tells_bytes_ ? ", byte " + std::to_string(position) : ", line " + std::to_string(lines);
    throw Error({.kind = kind,
                 .place = file_ + where,
                 .expected = std::string(expected),
                 .found = std::string(found),
                 .advice = std::string(advice)});
}

}  // namespace cellproj
