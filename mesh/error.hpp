// SPDX-License-Identifier: BSD-3-Clause
//
// The one exception type of cellproj, for everything that comes from outside: files, meshes, transfer functions,
// options, the environment. Degenerate geometry is no error, and a broken promise of the caller is an assert.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace cellproj {

enum class ErrorKind {
    file,         // a file or folder is missing, unreadable, of the wrong type or cannot be written
    format,       // the bytes of a file do not follow its format
    data,         // a file is well formed, what it says cannot be used (NaN points, indices out of range)
    option,       // a value given by the user is out of range or unknown
    environment,  // something is missing on this machine (a library, a program)
    mesher        // the mesher process failed, crashed or ran out of time
};

// What went wrong, told so that the reader can act. Every part but `expected`, `found` and `advice` must be given;
// what() joins them: "PLACE: expected EXPECTED, found FOUND; ADVICE".
struct ErrorParts {
    ErrorKind kind;
    std::string place;     // file and position, option name, or process: where to look
    std::string expected;  // what would have been right
    std::string found;     // what was there instead
    std::string advice;    // what the user can do now
};

class Error : public std::runtime_error {
public:
    explicit Error(ErrorParts parts);

    ErrorKind kind() const { return parts_.kind; }
    const std::string& place() const { return parts_.place; }
    const std::string& expected() const { return parts_.expected; }
    const std::string& found() const { return parts_.found; }
    const std::string& advice() const { return parts_.advice; }

private:
    ErrorParts parts_;
};

// The entry of `known` with the smallest edit distance to `word`; empty when `known` is empty. Ties go to the first.
std::string nearest_name(std::string_view word, std::span<const std::string> known);

// Throws Error (option) at `place` when `found` holds a key that is not in `known`, naming the nearest known one.
void require_known_keys(std::string_view place, std::span<const std::string> found, std::span<const std::string> known);

}  // namespace cellproj
