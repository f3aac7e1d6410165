// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/text_formats.hpp"
#include "tests/fuzz/fuzz_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    return cellproj::fuzz_one_file([](const auto& file) { return cellproj::read_gmsh(file); }, ".msh", bytes, size);
}
