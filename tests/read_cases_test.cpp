// SPDX-License-Identifier: BSD-3-Clause
//
// Real files of the formats that VTK reads, against what SOURCES.md says of them, and cut off.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace {

// ---- Real files ----

struct Expected {
    const char* file;
    const char* format;
    std::size_t points, cells, skipped_blocks;
    const char* field;  // its name; "" for none
    bool on_points;
    double low, high;  // of the magnitude
};

const std::vector<Expected> expected{
    {"volumes/hydrogen.vti", "VTK XML image", 262144, 250047, 0, "probability_density", true, 0, 1},
    {"volumes/HeadMRVolume.mhd", "MetaImage", 124992, 117547, 0, "MetaImage", true, 0, 255},
    {"volumes/RectGrid2.vtk", "VTK legacy rectilinear grid", 17061, 14720, 0, "vectors", true, 0, 10.3964},
    {"volumes/nrrd/BallBinary30x30x30.nrrd", "NRRD", 27000, 24389, 0, "ImageFile", true, 0, 257},
    {"volumes/nrrd/BallBinary30x30x30.nhdr", "NRRD", 27000, 24389, 0, "ImageFile", true, 0, 257},
    {"volumes/nrrd/BallBinary30x30x30_gz.nrrd", "NRRD", 27000, 24389, 0, "ImageScalars", true, 0, 257},
    {"kitchen/kitchen.vtk", "VTK legacy structured grid", 11424, 9936, 0, "velocity", true, 0, 0.452266},
    {"office/office.binary.vtk", "VTK legacy structured grid", 8400, 7220, 0, "vectors", true, 0, 0.804935},
    {"openfoam_case/cavity/case.foam", "OpenFOAM case", 882, 400, 0, "p", false, -4.36666, 4.84853},
    {"openfoam_case/cavity", "OpenFOAM case", 882, 400, 0, "p", false, -4.36666, 4.84853},
    {"openfoam_case/64BitFloats/case.foam", "OpenFOAM case", 12, 2, 0, "U", false, 1, 2},
    {"flange_openfoam/ensight/flange.case", "EnSight Gold", 7189, 5712, 4, "T", false, 274.313, 572.982},
    {"ensight_nfaced/TEST.case", "EnSight Gold", 350, 140, 1, "Velocity", false, 0.00721482, 0.0365523},
    {"ensight_nfaced/TEST_bin.case", "EnSight Gold", 350, 140, 1, "Velocity", false, 0.00721482, 0.0365522},
    {"disk_out_exodus/disk_out_ref.ex2", "Exodus II", 8499, 7472, 0, "V", true, 0, 22.4188},
    {"exodus_small/simple-cube-multi-element-order1.e", "Exodus II", 719, 1322, 0, "", true, 0, 0},
    {"cylinder3d_cgns/cylinder3D_adf.cgns", "CGNS", 5696, 27591, 0, "", true, 0, 0},
    {"cylinder3d_cgns/cylinder3D_hdf5.cgns", "CGNS", 5696, 27591, 0, "", true, 0, 0}};

void expect_range(const Field& f, double low, double high) {
    const auto components = static_cast<std::size_t>(f.components);
    double smallest = INFINITY, largest = -INFINITY;
    for (std::size_t row = 0; row < f.values.size() / components; ++row) {
        double squares = 0;
        for (std::size_t k = 0; k < components; ++k)
            squares += std::pow(f.values[row * components + k], 2);
        const double value = components == 1 ? f.values[row] : std::sqrt(squares);
        smallest = std::min(smallest, value);
        largest = std::max(largest, value);
    }
    const double digits = 1e-5 * std::max(std::abs(low), std::abs(high));  // SOURCES.md gives six
    EXPECT_NEAR(smallest, low, digits);
    EXPECT_NEAR(largest, high, digits);
}

TEST_F(ReadSharedData, EveryFormatAsSourcesSay) {
    for (const Expected& e : expected) {
        SCOPED_TRACE(e.file);
        const Dataset dataset = read(data / e.file);
        EXPECT_EQ(dataset.format, e.format);
        EXPECT_EQ(dataset.points.size(), e.points);
        EXPECT_EQ(dataset.cell_count(), e.cells);
        EXPECT_EQ(dataset.skipped_blocks, e.skipped_blocks);
        if (*e.field)
            expect_range(field(e.on_points ? dataset.point_fields : dataset.cell_fields, e.field), e.low, e.high);
    }
}

TEST_F(ReadSharedData, TimeStepsAndBlocksOfCases) {
    const fs::path cavity = data / "openfoam_case/cavity";
    EXPECT_EQ(read(cavity).time, 2.5);
    EXPECT_EQ(read(cavity).times.size(), 6U);
    const Dataset start = read(cavity / "system/controlDict", {.blocks = {"internalMesh"}, .time = 0.1});
    EXPECT_EQ(start.time, 0.0);
    expect_range(field(start.cell_fields, "p"), 0, 0);
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
