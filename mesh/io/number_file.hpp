// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: files of bare numbers, binary or in text, that say nothing about themselves.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh/number_type.hpp"

namespace cellproj {

// The number whose first byte is `bytes`[0], which has bytes_of(type) of them.
double decode_number(const char* bytes, NumberType type, bool big_endian);

// A whole file in memory. Places in it count bytes, or numbers if it is text: blanks, line ends or commas between them,
// "3*0.5" for three of them, exponents by e or (Fortran's) d.
class NumberFile {
public:
    // Text is what starts with nothing but the characters of numbers. Throws Error (file) when the file is missing or
    // unreadable, Error (format), with the line, for a text that holds anything but numbers.
    explicit NumberFile(const std::filesystem::path& file);

    bool is_text() const { return is_text_; }
    std::uint64_t size() const { return is_text_ ? numbers_.size() : bytes_.size(); }  // in bytes, or numbers of a text
    // The number at a place, which must hold it whole; of a text, whatever its type.
    double at(std::uint64_t place, NumberType type, bool big_endian) const;

private:
    void parse(const std::filesystem::path& file);

    std::string bytes_;
    std::vector<double> numbers_;
    bool is_text_ = false;
};

}  // namespace cellproj
