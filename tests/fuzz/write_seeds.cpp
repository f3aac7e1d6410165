// SPDX-License-Identifier: BSD-3-Clause
//
// Writes the small meshes of the tests as seeds: write_seeds FOLDER makes FOLDER/gmsh/…, FOLDER/medit/….
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/surface_files.hpp"
#include "tests/support/text_meshes.hpp"

namespace {

void write(const std::filesystem::path& file, const std::string& bytes) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace

int main(int count, char** arguments) {
    using namespace cellproj::testing_support;
    if (count != 2) return 2;
    const std::filesystem::path folder = arguments[1];
    for (const int version : {2, 4}) {
        for (const bool binary : {false, true}) {
            write(folder / "gmsh" / (std::to_string(version) + (binary ? "_binary" : "_ascii")),
                  gmsh_file(version, binary, 3));
        }
    }
    write(folder / "medit" / "sample", medit_file() + '\0' + medit_solutions());
    write(folder / "off" / "sample", off_file());
    for (const bool binary : {false, true})
        write(folder / "ply" / (binary ? "binary" : "ascii"), ply_file(binary));
    write(folder / "poly" / "poly", '\0' + poly_file());
    write(folder / "poly" / "smesh", '\1' + smesh_file());
    write(folder / "poly" / "with_nodes", std::string(1, '\0') + "0\n1 0\n1\n3 1 2 3\n0\n" + '\0' + tetgen_nodes(1));
    write(folder / "su2" / "sample", su2_file());
    // 2 x 2 x 2 points, all at the origin, the last but one a hole: 12 bytes of dimensions, 96 of coordinates, 32 of
    // IBLANK.
    const std::string one("\0\0\0\1", 4), two("\0\0\0\2", 4), zero(4, '\0');
    write(folder / "plot3d" / "binary",
          two + two + two + std::string(96, '\0') + one + one + one + one + one + one + zero + one);
    write(folder / "plot3d" / "text", "2\n2 2 2\n2 2 3\n24*0.5 8*1\n36*1d0 11*1 0\n");
    write(folder / "tetgen" / "sample", tetgen_nodes(1) + '\0' + tetgen_elements(1));
}
