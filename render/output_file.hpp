// SPDX-License-Identifier: BSD-3-Clause
//
// Files that appear under their name only when they are complete. Every output of cellproj, picture or text, goes this
// way: written beside its place under a temporary name, then renamed, so a failed run leaves nothing behind and an
// older file stays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>

namespace cellproj {

// Throws Error (file) unless `file` can be created (or replaced) in an existing, writable folder. Leaves nothing
// behind.
void require_writable(const std::filesystem::path& file);

// One output in the making. Symbolic links are followed. What cannot be replaced by renaming is written straight:
// devices, pipes, and /dev/stdout and /dev/stderr wherever they lead.
class OutputFile {
public:
    // Throws Error (file) as `require_writable` does.
    explicit OutputFile(const std::filesystem::path& file);
    // Without a successful `commit` the temporary file is removed.
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    // False when it fails (disk full) and ever after; the first reason is kept for `commit`. No exception, so that they
    // can be called from within C libraries.
    bool write(const void* data, std::size_t bytes) noexcept;
    bool seek(std::uint64_t position) noexcept;  // bytes from the start
    bool failed() const { return error_ != 0; }

    // Closes the file and gives it its name. Call it once, after the last write. Throws Error (file) when anything
    // failed.
    void commit();

private:
    void remember_error() noexcept;

    std::filesystem::path file_;       // as the user named it
    std::filesystem::path target_;     // the same behind symbolic links
    std::filesystem::path temporary_;  // empty when written straight or committed
    std::FILE* stream_ = nullptr;
    int error_ = 0;  // errno of the first failure
};

// Throws Error (file) when the text cannot be written completely.
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace cellproj
