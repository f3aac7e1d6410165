// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/file_bytes.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <system_error>

#include "mesh/error.hpp"

namespace cellproj {

void require_readable(const std::filesystem::path& file) {
    const auto fail = [&](ErrorKind kind, const std::string& found, const std::string& advice) {
        throw Error({.kind = kind, .place = file.string(), .expected = "a file", .found = found, .advice = advice});
    };
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) {
        fail(ErrorKind::file, error ? error.message() : "nothing there", "check the path");
    }
    if (std::filesystem::is_directory(status)) fail(ErrorKind::file, "a folder", "name a file in it");
    if (!std::filesystem::is_regular_file(status)) {
        fail(ErrorKind::file, "something that is no regular file", "name a file on disk");
    }
    if (!std::ifstream(file, std::ios::binary)) {
        fail(ErrorKind::file, "one that cannot be opened for reading", "check its permissions");
    }
    if (std::filesystem::file_size(file) == 0) {
        fail(ErrorKind::format, "an empty one (0 bytes)", "write or copy it again");
    }
}

std::string printable(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return std::isprint(c) == 0; }, '.');
    return text;
}

std::string read_bytes(const std::filesystem::path& file, std::uint64_t offset, std::size_t count) {
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(offset));
    std::string bytes(count, '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    return bytes;
}

}  // namespace cellproj
