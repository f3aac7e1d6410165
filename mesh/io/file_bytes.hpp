// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: a first look at files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace cellproj {

// Throws Error (file) unless `file` can be opened and is a regular file, Error (format) when it is empty.
void require_readable(const std::filesystem::path& file);

// With dots for control characters and bytes beyond ASCII: fit for messages.
std::string printable(std::string text);

// At most `count` bytes of a file from `offset` on; fewer where it ends.
std::string read_bytes(const std::filesystem::path& file, std::uint64_t offset, std::size_t count);

}  // namespace cellproj
