// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/memory_watch.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

namespace cellproj::bench {

namespace {

namespace fs = std::filesystem;

// Memory of a process that is in no file; its share of what it has in common with the process that it was forked from.
std::size_t anonymous_bytes(const std::string& process) {
    std::ifstream maps("/proc/" + process + "/smaps_rollup");
    for (std::string word; maps >> word;) {
        std::size_t kilobytes = 0;
        if (word == "Pss_Anon:" && maps >> kilobytes) return 1024 * kilobytes;
    }
    return 0;
}

std::size_t children_bytes() {
    std::size_t bytes = 0;
    std::error_code gone;
    for (const auto& task : fs::directory_iterator("/proc/self/task", gone)) {
        std::ifstream children(task.path() / "children");
        for (std::string child; children >> child;)
            bytes += anonymous_bytes(child);
    }
    return bytes;
}

std::size_t memory_file_bytes() {
    std::size_t bytes = 0;
    std::error_code gone;
    for (const auto& file : fs::directory_iterator("/proc/self/fd", gone)) {
        struct stat status {};
        const std::string name = fs::read_symlink(file, gone).string();
        if (name.starts_with("/memfd:") && stat(file.path().c_str(), &status) == 0)
            bytes += 512 * static_cast<std::size_t>(status.st_blocks);
    }
    return bytes;
}

std::size_t bytes_now() {
    return anonymous_bytes("self") + children_bytes() + memory_file_bytes();
}

}  // namespace

MemoryWatch::MemoryWatch() : start_(bytes_now()), peak_(start_) {
    thread_ = std::thread([this] {
        while (!done_) {
            peak_ = std::max<std::size_t>(peak_, bytes_now());
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
        }
    });
}

MemoryWatch::~MemoryWatch() {
    done_ = true;
    thread_.join();
}

}  // namespace cellproj::bench
