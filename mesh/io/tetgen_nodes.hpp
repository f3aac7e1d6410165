// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: what TetGen's formats of points, tetrahedra and surfaces share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/dataset.hpp"
#include "mesh/io/text_scanner.hpp"

namespace cellproj {

// A number and a blank or line end: the least that a column takes.
inline constexpr std::size_t tetgen_column_bytes = 2;

// The first line of a list may leave its last columns out: they count as 0 then.
std::size_t optional_tetgen_count(TextScanner& scanner, std::string_view what);

// The indices of a list rise by one from line to line.
void require_tetgen_index(TextScanner& scanner, std::int64_t expected);

// `fields` scalars of `rows` zeros, called "name_1", "name_2", …; a single one is called "name" unless it is numbered, too.
std::vector<Field> empty_tetgen_fields(const std::string& name, std::size_t fields, std::size_t rows,
                                       bool number_a_single_one);

// A list of points into `points` and `point_fields` of a dataset without any: its head, then one line each. Returns the
// index of the first point, 0 or 1, with which all indices start; 0 when the list is empty.
std::int64_t read_tetgen_nodes(TextScanner& scanner, Dataset& dataset);

}  // namespace cellproj
