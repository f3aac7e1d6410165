// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mesh/error.hpp"

namespace cellproj {

// Throws Error (data).
[[noreturn]] inline void refuse_grid(const std::string& place, const std::string& expected, const std::string& found,
                                     const std::string& advice) {
    throw Error({.kind = ErrorKind::data, .place = place, .expected = expected, .found = found, .advice = advice});
}

}  // namespace cellproj
