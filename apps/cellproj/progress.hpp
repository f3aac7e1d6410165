// SPDX-License-Identifier: BSD-3-Clause
//
// A line on the terminal while something takes longer than a second: "reading big.vtu … 62 %, 4 s".
#pragma once

#include <atomic>
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

    // How much is done, 0 to 1; not shown before it is known. From any thread.
    void set(double fraction) { percent_ = static_cast<int>(100.0 * fraction); }

private:
    void tick();

    std::string what_;
    std::atomic<int> percent_{-1};
    std::mutex mutex_;
    std::condition_variable wake_;
    bool done_ = false;
    std::thread thread_;
};

}  // namespace cellproj::cli
