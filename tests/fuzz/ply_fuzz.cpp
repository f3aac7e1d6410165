// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface.hpp"
#include "tests/fuzz/fuzz_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    return cellproj::fuzz_one_file(cellproj::read_ply, ".ply", bytes, size);
}
