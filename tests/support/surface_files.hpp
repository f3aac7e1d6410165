// SPDX-License-Identifier: BSD-3-Clause
//
// One small surface in each format that readers of our own read: the tetrahedron between the origin and the unit vectors.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace cellproj::testing_support {

inline const std::string corner_points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

inline std::string off_file() {
    return "OFF # by hand\n4 4 0\n" + corner_points + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3 0.5 0.5 0.5\n";
}

inline std::string ply_file(bool binary) {
    std::string bytes = std::string("ply\nformat ") + (binary ? "binary_big_endian" : "ascii") +
                        " 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 4\nproperty list uchar ushort vertex_indices\nend_header\n";
    constexpr std::array<std::array<std::uint8_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    if (!binary) return bytes + corner_points + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    const std::string zero(4, '\0'), one("\x3f\x80\0\0", 4);  // big-endian floats
    for (int vertex = 0; vertex < 4; ++vertex) {
        for (int axis = 0; axis < 3; ++axis)
            bytes += axis == vertex - 1 ? one : zero;
    }
    for (const auto& face : faces) {
        bytes += '\3';
        for (const std::uint8_t v : face)
            bytes += {'\0', static_cast<char>(v)};
    }
    return bytes;
}

// A facet of two polygons and a hole, a hole and a region.
inline std::string poly_file() {
    return "7 3 1 1 # points\n1 0 0 0 .5 1\n2 4 0 0 .5 1\n3 0 4 0 .5 1\n4 0 0 4 .5 1\n5 1 1 0 .5 1\n6 2 1 0 .5 1\n7 1 2 0 .5 1\n"
           "4 1\n2 1 3\n3 1 2 3\n3 5 6 7\n1 1.2 1.2 0\n1\n3 1 2 4\n1\n3 1 3 4\n1\n3 2 3 4\n"
           "1\n1 .5 .5 .5\n1\n1 .1 .1 .1 10 0.5\n";
}

inline std::string smesh_file() {
    return "4 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1\n3 0 1 2 -1\n3 0 1 3 -1\n3 0 2 3 -1\n3 1 2 3 -1\n0\n0\n";
}

}  // namespace cellproj::testing_support
