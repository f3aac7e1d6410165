// SPDX-License-Identifier: BSD-3-Clause
//
// A line on the terminal while something takes longer than a second: "reading big.vtu … 4 s".
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace cellproj::cli {

// Lives as long as the work. Silent for the first second, and altogether when standard error is no terminal.
class Progress {
public:
    explicit Progress(std::string what);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

private:
    void tick();

    std::string what_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool done_ = false;
    std::thread thread_;
};

}  // namespace cellproj::cli
