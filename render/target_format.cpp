// SPDX-License-Identifier: BSD-3-Clause
#include "render/target_format.hpp"

#include <array>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

const std::array<std::string, 4> names{"rgba8", "rgba16", "rgba16f", "rgba32f"};  // in the order of the enumeration

}  // namespace

TargetFormat parse_target_format(std::string_view text, const std::string& place) {
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (text == names[i]) return static_cast<TargetFormat>(i);
    }
    const std::string name(text);
    throw Error({ErrorKind::option, place, "rgba8, rgba16, rgba16f or rgba32f", name,
                 "did you mean \"" + nearest_name(name, names) + "\"?"});
}

std::string to_string(TargetFormat format) { return names[static_cast<std::size_t>(format)]; }

}  // namespace cellproj
