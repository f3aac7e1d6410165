// SPDX-License-Identifier: BSD-3-Clause
#include "render/output_file.hpp"

#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

Error file_error(const fs::path& file, std::string expected, std::string found, std::string advice) {
    return Error({.kind = ErrorKind::file,
                  .place = file.string(),
                  .expected = std::move(expected),
                  .found = std::move(found),
                  .advice = std::move(advice)});
}

Error system_error(const fs::path& file, std::string expected, int error) {
    const bool full = error == ENOSPC || error == EDQUOT;
    return file_error(file, std::move(expected), std::generic_category().message(error),
                      full ? "free some space there or choose another place" : "choose another place");
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// The descriptor that stands behind /dev/stdout and /dev/stderr, or −1. Opening these names anew would start at the
// beginning of a file that the output is redirected to, and renaming would replace it; the descriptor knows how far it
// was written.
int standard_descriptor(const fs::path& file) {
    return file == "/dev/stdout" ? STDOUT_FILENO : file == "/dev/stderr" ? STDERR_FILENO : -1;
}

// Renaming must not replace a device, a pipe or a socket.
bool is_written_straight(const fs::path& file) {
    std::error_code ignored;
    return standard_descriptor(file) >= 0 || fs::is_other(file, ignored);
}

std::FILE* open_straight(const fs::path& file) {
    const int descriptor = standard_descriptor(file);
    if (descriptor < 0) return std::fopen(file.c_str(), "wb");
    std::fflush(stdout);  // what was printed before stands before
    return ::fdopen(::dup(descriptor), "wb");
}

// The place to write to, behind symbolic links, after the checks whose answers deserve words of their own.
fs::path checked_target(const fs::path& file) {
    std::error_code ignored;
    if (!file.has_filename() || fs::is_directory(file, ignored))
        throw file_error(file, "the name of a file", file.empty() ? "an empty name" : "a folder", "add a file name");
    const fs::path folder = folder_of(file);
    if (!fs::is_directory(folder, ignored)) {
        const bool exists = fs::exists(folder, ignored);
        throw file_error(file, "an existing folder " + folder.string(), exists ? "something else of that name" : "none",
                         exists ? "choose another place" : "create the folder first");
    }
    if (is_written_straight(file) || !fs::exists(file, ignored)) return file;
    // Renaming would replace even a write-protected file; who protected it does not want that.
    if (::access(file.c_str(), W_OK) != 0) throw system_error(file, "a file that may be replaced", errno);
    return fs::canonical(file);
}

// A new, empty file beside `target`. The name does not grow with the target's, which may be as long as names can be.
std::FILE* create_temporary(const fs::path& target, fs::path& temporary) {
    static std::atomic<unsigned> counter = 0;
    std::FILE* stream = nullptr;
    do {
        temporary =
            folder_of(target) / (".cellproj-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp");
        stream = std::fopen(temporary.c_str(), "wbx");
    } while (!stream && errno == EEXIST);  // left by a killed process that had our number
    return stream;
}

}  // namespace

void require_writable(const fs::path& file) {
    // Opening a pipe would wait for its reader, and closing it again would end the reader's input: not to be tried out.
    if (!is_written_straight(checked_target(file))) const OutputFile tried_and_removed(file);
}

OutputFile::OutputFile(const fs::path& file) : file_(file), target_(checked_target(file)) {
    stream_ = is_written_straight(target_) ? open_straight(target_) : create_temporary(target_, temporary_);
    if (!stream_) throw system_error(file_, "a folder where files can be created", errno);
}

OutputFile::~OutputFile() {
    if (stream_) std::fclose(stream_);
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

bool OutputFile::write(const void* data, std::size_t bytes) noexcept {
    if (!failed() && std::fwrite(data, 1, bytes, stream_) != bytes) remember_error();
    return !failed();
}

bool OutputFile::seek(std::uint64_t position) noexcept {
    if (!failed() && ::fseeko(stream_, static_cast<off_t>(position), SEEK_SET) != 0) remember_error();
    return !failed();
}

void OutputFile::remember_error() noexcept {
    error_ = errno != 0 ? errno : EIO;
}

void OutputFile::commit() {
    assert(stream_ && "commit is called once");
    if (std::fclose(std::exchange(stream_, nullptr)) != 0 && !failed()) remember_error();
    if (failed()) throw system_error(file_, "room for the whole file", error_);
    if (temporary_.empty()) return;
    std::error_code error;
    fs::rename(temporary_, target_, error);
    if (error) throw system_error(file_, "a file that can be replaced", error.value());
    temporary_.clear();
}

void write_text_file(const fs::path& file, std::string_view text) {
    OutputFile out(file);
    out.write(text.data(), text.size());
    out.commit();
}

}  // namespace cellproj
