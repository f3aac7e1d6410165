// SPDX-License-Identifier: BSD-3-Clause
//
// The programs of a renderer, each made when it is first asked for.
#pragma once

#include <map>
#include <string>

#include "classify/method.hpp"
#include "render/gl/objects.hpp"

namespace cellproj::gl {

class Programs {
public:
    // As Program's constructor. Valid as long as this is.
    const Program& of(const std::string& vertex, const std::string& fragment, const std::string& defines) {
        const std::string key = defines + vertex + fragment;
        const auto known = programs_.find(key);
        if (known != programs_.end()) return known->second;
        return programs_[key] = Program(vertex, fragment, defines);
    }

private:
    std::map<std::string, Program> programs_;  // by their text
};

// For shaders that end a fragment's light by the method's blending.
inline const char* blending_define(const Method& method) {
    return method.blending == Blending::half ? "#define HALF_OPACITY\n" : "";
}

}  // namespace cellproj::gl
