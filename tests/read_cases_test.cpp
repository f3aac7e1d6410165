// SPDX-License-Identifier: BSD-3-Clause
//
// Real files of the formats that VTK reads, their blocks and time steps, and cut off.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace read_cases_test {

// ---- Real files ----

TEST_F(ReadSharedData, TimeStepsAndBlocksOfCases) {
    const fs::path cavity = data / "openfoam_case/cavity";
    EXPECT_EQ(read(cavity).time, 2.5);
    EXPECT_EQ(read(cavity).times.size(), 6U);
    const Dataset start = read(cavity / "system/controlDict", {.blocks = {"internalMesh"}, .time = 0.1});
    EXPECT_EQ(start.time, 0.0);
    EXPECT_EQ(field(start.cell_fields, "p").values, std::vector<double>(400, 0.0));
    const fs::path cube = data / "exodus_small/simple-cube-multi-element-order1.e";
    EXPECT_EQ(read(cube, {.blocks = {"tet4"}}).cells.size(), 295U);
    EXPECT_EQ(read(cube, {.blocks = {"hex8", "wedge6"}}).cells.size(), 277U);
}

// ---- Damage, and a case made of another ----

class ReadDamagedCase : public ReadSharedData {
protected:
    // A copy of the folder of `entry`, to be damaged.
    fs::path copy(const std::string& entry) const {
        const fs::path folder = scratch_folder() / fs::path(entry).parent_path().filename();
        fs::remove_all(folder);
        fs::copy(data / fs::path(entry).parent_path(), folder, fs::copy_options::recursive);
        for (const auto& inside : fs::recursive_directory_iterator(folder)) {
            fs::permissions(inside, fs::perms::owner_all, fs::perm_options::add);
        }
        return folder / fs::path(entry).filename();
    }
};

TEST_F(ReadDamagedCase, FilesOfCases) {
    const std::map<std::string, std::vector<std::string>> damaged{
        {"exodus_small/simple-cube-multi-element-order1.e", {"simple-cube-multi-element-order1.e"}},
        {"volumes/nrrd/BallBinary30x30x30_gz.nrrd", {"BallBinary30x30x30_gz.nrrd"}},
        {"openfoam_case/64BitFloats/case.foam", {"constant/polyMesh/points", "constant/polyMesh/faces", "0/p"}},
        {"cylinder3d_cgns/cylinder3D_hdf5.cgns", {"cylinder3D_hdf5.cgns"}},
        {"ensight_nfaced/TEST_bin.case", {"TEST_bin.case", "test_bin.geo", "test_bin.pressure.0001"}}};
    for (const auto& [entry, files] : damaged) {
        const fs::path copied = copy(entry);
        for (const std::string& file : files)
            expect_cuts_told(copied, copied.parent_path() / file);
    }
}

// A case of two processors, each of which holds the whole mesh: twice the cells.
TEST_F(ReadDamagedCase, DecomposedOpenFoam) {
    const fs::path folder = copy("openfoam_case/cavity/case.foam").parent_path();
    for (const char* processor : {"processor0", "processor1"}) {
        fs::create_directories(folder / processor);
        for (const char* part : {"constant", "0", "2.5"}) {
            fs::copy(folder / part, folder / processor / part, fs::copy_options::recursive);
        }
    }
    for (const char* part : {"constant", "0", "0.5", "1", "1.5", "2", "2.5"})
        fs::remove_all(folder / part);
    const Dataset dataset = read(folder);
    EXPECT_EQ(dataset.format, "OpenFOAM case, decomposed");
    EXPECT_EQ(dataset.cell_count(), 800U);
    EXPECT_EQ(dataset.time, 2.5);
}

}  // namespace
}  // namespace cellproj
