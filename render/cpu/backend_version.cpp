// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/backend_version.hpp"

#include <oneapi/tbb/task_arena.h>

#include "render/cpu/kernels.hpp"

namespace cellproj::cpu {

std::string backend_version() {
    const int threads = oneapi::tbb::this_task_arena::max_concurrency();
    return instruction_set() + ", " + std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

}  // namespace cellproj::cpu
