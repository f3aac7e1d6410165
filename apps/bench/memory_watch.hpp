// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>

namespace cellproj::bench {

// The most memory that this process, its children and the memory files between them hold at one time while this lives,
// beyond what they held at its start [bytes]. Sampled every few milliseconds from /proc: the peaks that the system counts
// for each process by itself do not add up.
class MemoryWatch {
public:
    MemoryWatch();
    ~MemoryWatch();
    MemoryWatch(const MemoryWatch&) = delete;
    MemoryWatch& operator=(const MemoryWatch&) = delete;

    std::size_t peak() const { return peak_ > start_ ? peak_ - start_ : 0; }

private:
    std::size_t start_;
    std::atomic<std::size_t> peak_;
    std::atomic<bool> done_{false};
    std::thread thread_;
};

}  // namespace cellproj::bench
