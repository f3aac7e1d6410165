// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/cpu_time.hpp"

#include <sys/resource.h>

namespace cellproj::bench {

double user_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1e3 * static_cast<double>(usage.ru_utime.tv_sec) + 1e-3 * static_cast<double>(usage.ru_utime.tv_usec);
}

}  // namespace cellproj::bench
