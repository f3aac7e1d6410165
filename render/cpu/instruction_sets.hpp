// SPDX-License-Identifier: BSD-3-Clause
//
// The instruction sets that kernels are compiled for: to be included before hwy/foreach_target.h. Private to render/cpu.
#pragma once

// SSE4 and AVX-512 without the extras of Ice Lake do what these would do.
#ifdef CELLPROJ_FEW_INSTRUCTION_SETS  // builds with sanitizers: AVX-512 and what the compiler may assume
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_AVX2)
#else
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#endif
