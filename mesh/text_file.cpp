// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "mesh/error.hpp"

namespace cellproj {

std::string read_text_file(const std::filesystem::path& file, const std::string& what) {
    const auto fail = [&](const std::string& found) {
        throw Error({ErrorKind::file, file.string(), what, found, "check the path and its permissions"});
    };
    if (std::filesystem::is_directory(file)) fail("a folder");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) fail(std::strerror(errno));
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (stream.bad()) fail("a read error");
    return text;
}

}  // namespace cellproj
