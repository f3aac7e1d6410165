// SPDX-License-Identifier: BSD-3-Clause
//
// Whether this machine has a GPU that can draw.
#pragma once

#include <string>

namespace cellproj {

struct Gpu {
    bool found = false;
    std::string what = "no GPU was looked for";  // its name by the driver, or why there is none, in words
};

}  // namespace cellproj
