// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/ and apps/: whether a file holds a surface, and in which format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

namespace cellproj {

enum class SurfaceFormat { stl_ascii, stl_binary, off, ply, obj, vtp, poly, smesh };

// In words, for messages: "ascii STL".
const char* name(SurfaceFormat format);

// Told by the content; of formats without a mark (OBJ, TetGen, STL that is cut off), by the suffix. None for anything else:
// a volume mesh, a folder, nothing at all.
std::optional<SurfaceFormat> detect_surface_format(const std::filesystem::path& file);

// The size of the binary STL file that starts with these bytes; 0 when they are too few.
std::uint64_t announced_stl_size(std::string_view head);

}  // namespace cellproj
