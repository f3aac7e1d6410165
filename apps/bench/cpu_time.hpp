// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace cellproj::bench {

// Milliseconds of user CPU time of this process so far, all threads.
double user_ms();

}  // namespace cellproj::bench
