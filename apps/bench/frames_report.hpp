// SPDX-License-Identifier: BSD-3-Clause
//
// The rows of cellproj_frames as text.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/frames_run.hpp"

namespace cellproj::bench {

// Columns under each other, for a terminal; those that no row knows are left out. `times_vtk` is how many frames are drawn in the time
// of one of the fastest of VTK's mappers in the same situation (wall clock).
std::string to_table(const std::vector<Row>& rows);
// The same as a table of Markdown.
std::string to_markdown(const std::vector<Row>& rows);
// All columns, plain numbers; what is not known is empty.
std::string to_csv(const std::vector<Row>& rows);

}  // namespace cellproj::bench
