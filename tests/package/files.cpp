// SPDX-License-Identifier: BSD-3-Clause
//
// Reads a file as its user would, "files mesh FILE" or "files surface FILE", and says what came of it: tests/check_package.sh
// asks it without VTK.
#include <cstdio>
#include <string>

#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/surface.hpp"

int main(int count, char** arguments) {
    if (count != 3) return 2;
    const std::string kind = arguments[1];
    try {
        const std::size_t points = kind == "surface" ? cellproj::read_surface(arguments[2]).points.size()
                                                     : cellproj::read(arguments[2]).points.size();
        std::printf("%zu points\n", points);
        return 0;
    } catch (const cellproj::Error& error) {
        std::printf("%s\n", error.what());
        return 1;
    }
}
