// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/text_formats.hpp"
#include "tests/fuzz/fuzz_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    return cellproj::fuzz_two_files([](const auto& file) { return cellproj::read_tetgen(file); }, ".node", ".ele", bytes, size);
}
