// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/number_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"

namespace cellproj {

namespace {

constexpr std::string_view separators = " \t\r\n,";

template <class T>
double decode(const char* bytes, bool big_endian) {
    std::array<char, sizeof(T)> own{};
    std::memcpy(own.data(), bytes, own.size());
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(own.begin(), own.end());
    return static_cast<double>(std::bit_cast<T>(own));
}

bool looks_like_text(std::string_view head) {
    return !head.empty() && head.find_first_not_of("0123456789+-.*eEdD, \t\r\n") == std::string_view::npos;
}

std::optional<double> parse_number(std::string_view word) {
    std::string digits(word.substr(word.starts_with('+') ? 1 : 0));
    std::replace_if(
        digits.begin(), digits.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
    double value = 0.0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    // Out of range: too small for float64 as often as too large; neither is worth losing the file.
    if (error == std::errc::result_out_of_range && digits.find("e-") != std::string::npos) return 0.0;
    if (error != std::errc() || stop != digits.data() + digits.size()) return std::nullopt;
    return value;
}

}  // namespace

double decode_number(const char* bytes, NumberType type, bool big_endian) {
    switch (type) {
        case NumberType::int8:
            return decode<std::int8_t>(bytes, big_endian);
        case NumberType::uint8:
            return decode<std::uint8_t>(bytes, big_endian);
        case NumberType::int16:
            return decode<std::int16_t>(bytes, big_endian);
        case NumberType::uint16:
            return decode<std::uint16_t>(bytes, big_endian);
        case NumberType::int32:
            return decode<std::int32_t>(bytes, big_endian);
        case NumberType::uint32:
            return decode<std::uint32_t>(bytes, big_endian);
        case NumberType::float32:
            return decode<float>(bytes, big_endian);
        case NumberType::float64:
            break;
    }
    return decode<double>(bytes, big_endian);
}

NumberFile::NumberFile(const std::filesystem::path& file) {
    require_readable(file);
    const std::uint64_t size = std::filesystem::file_size(file);
    bytes_ = read_bytes(file, 0, size);
    constexpr std::size_t head = 4096;
    is_text_ = looks_like_text(std::string_view(bytes_).substr(0, head));
    if (is_text_) parse(file);
}

void NumberFile::parse(const std::filesystem::path& file) {
    const std::string_view text(bytes_);
    // Repeated numbers are values that all points share: a damaged count must not fill the memory.
    const std::size_t most = 1'000'000 + 64 * text.size();
    for (std::size_t begin = 0; (begin = text.find_first_not_of(separators, begin)) != std::string_view::npos;) {
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        std::string_view word = text.substr(begin, end - begin);
        std::size_t count = 1;
        bool good = true;
        if (const std::size_t star = word.find('*'); star != std::string_view::npos) {
            const auto [stop, error] = std::from_chars(word.data(), word.data() + star, count);
            good = error == std::errc() && stop == word.data() + star;
            word.remove_prefix(star + 1);
        }
        const std::optional<double> value = parse_number(word);
        good = good && value && count <= most - numbers_.size();
        if (!good) {
            const auto line = std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin), '\n') + 1;
            throw Error(
                {.kind = ErrorKind::format,
                 .place = file.string() + ", line " + std::to_string(line),
                 .expected = "nothing but numbers",
                 .found =
                     "\"" + printable(std::string(text.substr(begin, std::min<std::size_t>(end - begin, 40)))) + "\"",
                 .advice = "the file may be damaged or of another format: write it again"});
        }
        numbers_.insert(numbers_.end(), count, *value);
        begin = end;
    }
    bytes_ = std::string();
}

double NumberFile::at(std::uint64_t place, NumberType type, bool big_endian) const {
    if (is_text_) return numbers_[place];
    assert(place + bytes_of(type) <= bytes_.size());
    return decode_number(bytes_.data() + place, type, big_endian);
}

}  // namespace cellproj
