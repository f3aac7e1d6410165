// SPDX-License-Identifier: BSD-3-Clause
//
// Small text files, whole.
#pragma once

#include <filesystem>
#include <string>

namespace cellproj {

// Throws Error (file) when the file is missing, a folder or unreadable; `what` says what was expected there ("a camera file").
std::string read_text_file(const std::filesystem::path& file, const std::string& what);

}  // namespace cellproj
