// SPDX-License-Identifier: BSD-3-Clause
#include "progress.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <utility>

namespace cellproj::cli {

Progress::Progress(std::string what) : what_(std::move(what)) {
    if (isatty(STDERR_FILENO)) thread_ = std::thread([this] { tick(); });
}

Progress::~Progress() {
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Progress::tick() {
    std::unique_lock lock(mutex_);
    int seconds = 0;
    while (!wake_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; })) {
        const int percent = percent_;
        const std::string done = percent < 0 ? "" : std::to_string(percent) + " %, ";
        std::fprintf(stderr, "\r\033[K%s … %s%d s", what_.c_str(), done.c_str(), ++seconds);
    }
    if (seconds > 0) std::fprintf(stderr, "\r\033[K");  // back to the start of the line, erased
}

}  // namespace cellproj::cli
