// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace cellproj::cpu {

// What draws, for statistics: the instruction set and how many threads the calling task's arena has, "AVX3, 2 threads".
std::string backend_version();

}  // namespace cellproj::cpu
