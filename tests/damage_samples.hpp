// SPDX-License-Identifier: BSD-3-Clause
//
// One small good file per format and encoding, to be damaged.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace cellproj::testing_support {

struct DamageSample {
    std::string name;                // of the test
    std::vector<std::string> files;  // to be damaged, relative to the entry's folder
    // Writes the files into a folder (or copies them there from the folder of real files) and returns the one to read.
    std::function<std::filesystem::path(const std::filesystem::path& folder, const std::filesystem::path& real)> prepare;
    std::string source = {};         // the real folder or file it comes from; empty: it is written here
    bool surface = false;
    std::string solution = {};       // of a PLOT3D grid
    std::size_t flips_at_once = 1;   // more where one read takes long
    // A file may end after any of its parts or in its last number: neither an end nor a number of parts is written down
    // (or, EnSight's values, VTK's reader does not look at it).
    bool open_ended = false;
};

std::vector<DamageSample> damage_samples();

inline std::ostream& operator<<(std::ostream& out, const DamageSample& sample) {
    return out << sample.name;
}

}  // namespace cellproj::testing_support
