// SPDX-License-Identifier: BSD-3-Clause
//
// The first byte chooses between .poly and .smesh.
#include "mesh/surface.hpp"
#include "tests/fuzz/fuzz_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    if (size == 0) return 0;
    const char* const suffix = bytes[0] % 2 == 0 ? ".poly" : ".smesh";
    return cellproj::fuzz_two_files(cellproj::read_poly, suffix, ".node", bytes + 1, size - 1);
}
