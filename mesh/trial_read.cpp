// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/trial_read.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "mesh/error.hpp"
#include "mesh/file_bytes.hpp"

namespace cellproj {

namespace {

// A file in memory, which the child writes and the parent reads; unlike a pipe it never fills up.
class MemoryFile {
public:
    MemoryFile() : descriptor_(memfd_create("cellproj", 0)) {
        if (descriptor_ >= 0) return;
        throw Error({.kind = ErrorKind::environment,
                     .place = "trial read",
                     .expected = "a file in memory",
                     .found = std::strerror(errno),
                     .advice = "close some files or programs"});
    }
    ~MemoryFile() { close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    int descriptor() const { return descriptor_; }
    void write(const std::string& text) const {
        [[maybe_unused]] const ssize_t written = ::write(descriptor_, text.data(), text.size());
    }
    // At most its first 4000 bytes.
    std::string content() const {
        std::string text(4000, '\0');
        const ssize_t size = pread(descriptor_, text.data(), text.size(), 0);
        text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
        return text;
    }

private:
    int descriptor_;
};

// The parts of an Error between zero bytes, the kind first.
std::string pack(const Error& error) {
    const std::string zero(1, '\0');
    return std::to_string(static_cast<int>(error.kind())) + zero + error.place() + zero + error.expected() + zero +
           error.found() + zero + error.advice() + zero;
}

[[noreturn]] void throw_packed(const std::string& text) {
    std::array<std::string, 5> parts;
    std::size_t at = 0;
    for (std::string& part : parts) {
        const std::size_t end = std::min(text.find('\0', at), text.size());
        part = text.substr(std::min(at, text.size()), end - at);
        at = end + 1;
    }
    throw Error({static_cast<ErrorKind>(std::atoi(parts[0].c_str())), parts[1], parts[2], parts[3], parts[4]});
}

[[noreturn]] void run_in_child(const MemoryFile& printed, const MemoryFile& error, const std::function<void()>& work) {
    dup2(printed.descriptor(), STDOUT_FILENO);
    dup2(printed.descriptor(), STDERR_FILENO);
    for (const int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL})
        std::signal(number, SIG_DFL);
    try {
        work();
    } catch (const Error& failure) {
        error.write(pack(failure));
    } catch (const std::exception& failure) {
        printed.write(failure.what());
    }
    _exit(0);
}

// The status of the child, or none (after its end by force) when it ran too long.
std::optional<int> wait_for(pid_t child, std::chrono::duration<double> limit) {
    const auto start = std::chrono::steady_clock::now();
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (std::chrono::steady_clock::now() - start > limit) {
            kill(child, SIGKILL);
            waitpid(child, &status, 0);
            return std::nullopt;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return status;
}

[[noreturn]] void throw_damaged(const std::filesystem::path& file, const std::string& found) {
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a complete and well-formed file",
                 .found = found,
                 .advice = "it, or a file it names, may be cut off or damaged: write or copy it again"});
}

}  // namespace

void require_harmless(const std::filesystem::path& file, std::uintmax_t bytes, const std::function<void()>& work) {
    const MemoryFile printed;
    const MemoryFile error;
    const pid_t child = fork();
    if (child < 0) {
        throw Error({.kind = ErrorKind::environment,
                     .place = file.string(),
                     .expected = "a child process to try the reader in",
                     .found = std::strerror(errno),
                     .advice = "end other processes or free memory"});
    }
    if (child == 0) run_in_child(printed, error, work);
    const auto limit = std::chrono::duration<double>(8.0 + static_cast<double>(bytes) / 5e6);
    const std::optional<int> status = wait_for(child, limit);
    if (!status) throw_damaged(file, "one that keeps VTK's reader busy without end");
    if (WIFSIGNALED(*status))
        throw_damaged(file, "one that crashes VTK's reader (signal " + std::to_string(WTERMSIG(*status)) + ")");
    if (WEXITSTATUS(*status) != 0) throw_damaged(file, "one that VTK's reader gives up on");
    const std::string failure = error.content();
    if (!failure.empty()) throw_packed(failure);
    const std::string text = printed.content();
    if (!text.empty()) {
        throw_damaged(file, "what VTK's reader calls \"" +
                                printable(text.substr(0, std::min<std::size_t>(text.find('\n'), 200))) + "\"");
    }
}

}  // namespace cellproj
