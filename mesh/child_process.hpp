// SPDX-License-Identifier: BSD-3-Clause
//
// Runs a program that may crash, hang or talk nonsense, without harm to the caller: no SIGPIPE, no zombie, no open
// descriptor is left behind. POSIX.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace cellproj {

struct ChildResult {
    enum class End {
        exited,     // `code` is its exit status
        signalled,  // `code` is the signal it died of
        timed_out,  // killed after the time limit
        stopped     // killed because `refuse` was true
    };

    End end = End::exited;
    int code = 0;
    std::string output;    // its standard output
    std::string messages;  // its standard error, the last 64 KiB or so
};

// Starts `program` without arguments, in a process group of its own, gives it `input` on its standard input and waits
// for it to end. On a time-out [seconds, > 0] and when `refuse` (asked with the output so far, after each piece of it)
// returns true, the whole process group is killed. Throws Error (environment) when the program cannot be started.
ChildResult run_child(const std::filesystem::path& program, std::string_view input, double timeout_seconds,
                      const std::function<bool(std::string_view output)>& refuse);

}  // namespace cellproj
