// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/resource.h>

namespace cellproj::bench {

// Milliseconds of user CPU time of this process so far, all threads.
inline double user_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1e3 * static_cast<double>(usage.ru_utime.tv_sec) + 1e-3 * static_cast<double>(usage.ru_utime.tv_usec);
}

}  // namespace cellproj::bench
