// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/merge_blocks.hpp"
#include "mesh/text_formats.hpp"
#include "tests/fuzz/fuzz_reader.hpp"

namespace {

// A curvilinear grid as the hexahedra it stands for, which are checked like all others.
cellproj::Dataset read_grid(const std::filesystem::path& file) {
    cellproj::Dataset dataset = cellproj::read_plot3d(file, {}, {});
    if (dataset.grid) dataset.cells = cellproj::hexahedra_of(*dataset.grid);
    return dataset;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    return cellproj::fuzz_one_file(read_grid, ".xyz", bytes, size);
}
