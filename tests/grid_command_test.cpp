// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids as a user draws them: `cellproj render` of voxels, images and rectilinear grids.
#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/folder_test.hpp"

namespace {

using cellproj::testing_support::FolderTest;
using cellproj::testing_support::Outcome;
using cellproj::testing_support::run_program;

class GridCommand : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        std::string numbers;
        for (int i = 0; i < 4 * 5 * 6; ++i) numbers += static_cast<char>(10 * (i / 20));  // rises with z
        write("v.raw", numbers);
    }

    static constexpr const char* voxels = "v.raw --dims 4 5 6 --type uint8";

    Outcome run(const std::string& options) const { return run_program(folder_, "render --size 240x200 -o p.png " + options); }

    std::string drawn_as(const std::string& options) const {
        const Outcome outcome = run(options + " --stats s.json");
        EXPECT_EQ(outcome.code, 0) << outcome.text;
        const auto picture = nlohmann::json::parse(content("s.json")).at("pictures").at(0);
        EXPECT_GT(picture.at("counts").at("fragments").get<int>() + picture.at("counts").at("triangles").get<int>(), 0);
        return picture.at("drawn_as");
    }

    void expect_refused(const std::string& options, std::initializer_list<const char*> words) const {
        const Outcome outcome = run(options);
        EXPECT_EQ(outcome.code, 1) << options << "\n" << outcome.text;
        for (const char* word : words) EXPECT_NE(outcome.text.find(word), std::string::npos) << "no \"" << word << "\" in: " << outcome.text;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "p.png")) << options;
    }

    // A rectilinear grid of points along x and z, 0 and 1 along y.
    void write_rectilinear(const std::string& name, const std::string& x, int nx, const std::string& z, int nz) const {
        const std::string extent = "0 " + std::to_string(nx - 1) + " 0 1 0 " + std::to_string(nz - 1);
        std::string values;
        for (int i = 0; i < nx * 2 * nz; ++i) values += std::to_string(i) + " ";
        const auto array = [](const std::string& of, const std::string& numbers) {
            return "<DataArray type=\"Float64\" Name=\"" + of + "\" format=\"ascii\">" + numbers + "</DataArray>";
        };
        write(name, "<VTKFile type=\"RectilinearGrid\" version=\"0.1\"><RectilinearGrid WholeExtent=\"" + extent + "\"><Piece Extent=\"" + extent +
                        "\"><PointData Scalars=\"f\">" + array("f", values) + "</PointData><Coordinates>" + array("x", x) + array("y", "0 1") +
                        array("z", z) + "</Coordinates></Piece></RectilinearGrid></VTKFile>");
    }
};

TEST_F(GridCommand, AGridIsDrawnAsItIs) {
    EXPECT_EQ(drawn_as(voxels), "grid");
    EXPECT_NE(content("p.png").find("cellproj drawn as"), std::string::npos);
    EXPECT_EQ(drawn_as(std::string(voxels) + " --as grid --method exact:1e-4 --projection parallel --nan 3"), "grid");
    EXPECT_EQ(drawn_as(std::string(voxels) + " --as tets"), "tetrahedra");
    write_rectilinear("r.vtr", "0 1 3", 3, "0 0.5 2", 3);
    EXPECT_EQ(drawn_as("r.vtr --color-bar --outline"), "grid");
    const Outcome words = run(voxels);
    EXPECT_NE(words.text.find("60 of 60 cells of the grid"), std::string::npos) << words.text;
}

TEST_F(GridCommand, WhatOnlyTetrahedraKnowIsDrawnByThem) {
    for (const char* option : {"--iso 20 --iso-method table", "--order mpvo", "--cell-values averaged", "--verify-order", "--max-error 0.1"}) {
        EXPECT_EQ(drawn_as(std::string(voxels) + " " + option), "tetrahedra") << option;
        std::filesystem::remove(folder_ / "p.png");
        expect_refused(std::string(voxels) + " --as grid " + option, {"regular grid", "--as tets"});
    }
    for (const char* option : {"--target rgba8", "--method shirley-tuchman", "--opacity-field Points:x"})
        expect_refused(std::string(voxels) + " --as grid " + option, {"regular grid", "--as tets"});
    EXPECT_EQ(run(std::string(voxels) + " --as boxes").code, 2);
}

TEST_F(GridCommand, RaysThroughAGridAreCutInIt) {
    for (const char* option : {"--clip 1,1,1:0,0,1", "--clip-box 0,0,0,2,2,2", "--clip 1,1,1:0,0,-1 --caps", "--surface demo:sphere", "--slice 1,1,1:1,1,1 --volume"})
        for (const char* backend : {" --backend cpu", " --backend gl"}) EXPECT_EQ(drawn_as(std::string(voxels) + " " + option + backend), "grid") << option;
    EXPECT_EQ(drawn_as(std::string(voxels) + " --clip 1,1,1:0,0,1 --verify-order"), "tetrahedra");
    std::filesystem::remove(folder_ / "p.png");
    expect_refused(std::string(voxels) + " --slice 1,1,1:1,1,1 --sampling object:8", {"--sampling", "1 slice", "object:8"});
}

TEST_F(GridCommand, IsosurfacesAreThoseOfTheGrid) {
    for (const char* option : {"--iso 20", "--iso 20 --backend gl", "--iso 15,25 --shading flat --light 1,0,0", "--iso 20:red:0.5 --volume --as grid"})
        EXPECT_EQ(drawn_as(std::string(voxels) + " " + option), "grid") << option;
    const Outcome explained = run(std::string(voxels) + " --iso 20,30 --explain");
    for (const char* words : {"exact roots", "of all points", "nothing is seen between the isosurfaces"})
        EXPECT_NE(explained.text.find(words), std::string::npos) << explained.text;
    const Outcome slabs = run(std::string(voxels) + " --iso 20 --sampling view:30 --shading unlit --explain");
    for (const char* words : {"by slabs", "unlit"}) EXPECT_NE(slabs.text.find(words), std::string::npos) << slabs.text;
    EXPECT_EQ(drawn_as(std::string(voxels) + " --iso 20 --as tets"), "tetrahedra");
}

TEST_F(GridCommand, OpenGlDrawsCellsAndSlabs) {
    for (const char* option : {"--backend gl", "--backend gl --method homogeneous:vertices --target rgba16f", "--sampling object:8",
                               "--sampling view:9:post:x2 --method preint2d --as grid"})
        EXPECT_EQ(drawn_as(std::string(voxels) + " " + option), "grid") << option;
    std::filesystem::remove(folder_ / "p.png");
    expect_refused(std::string(voxels) + " --sampling object:8 --backend cpu", {"--sampling", "--backend gl"});
    expect_refused(std::string(voxels) + " --sampling object:8 --as tets", {"--sampling", "tetrahedra"});
    expect_refused(std::string(voxels) + " --sampling object:8:post --iso 20", {"--sampling", "object:8:post"});
    expect_refused(std::string(voxels) + " --sampling objects:8", {"--sampling", "did you mean \"object\""});
    expect_refused(std::string(voxels) + " --as grid --backend gl --method exact", {"--method", "exact"});
}

TEST_F(GridCommand, BadGridsAreRefusedWithTheirPlace) {
    write_rectilinear("turns.vtr", "0 1 0.5", 3, "0 1", 2);
    expect_refused("turns.vtr", {"turns.vtr, axis x, point 2", "ascend", "0.5 behind 1"});
    write_rectilinear("twice.vtr", "0 1", 2, "0 1 1", 3);
    expect_refused("twice.vtr", {"axis z, point 2", "other than that of the point before"});
    write_rectilinear("flat.vtr", "0 1 2", 3, "0", 1);
    expect_refused("flat.vtr", {"flat.vtr"});
    expect_refused("v.raw --dims 4 5 7 --type uint8", {"v.raw", "140", "120"});
    expect_refused("v.raw --dims 1 5 6 --type uint8", {"v.raw"});
    expect_refused("v.raw --dims 4 5 6 --type uint8 --spacing 1 0 1", {"spacing", "0"});
    write("t.off", "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    expect_refused("t.off --tetrahedralize --as grid", {"--tetrahedralize", "regular grid"});
    write("t.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\n"
                   "CELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS f float 1\nLOOKUP_TABLE default\n0 1 2 3\n");
    expect_refused("t.vtk --as grid", {"one grid of boxes", "unstructured"});
    EXPECT_EQ(drawn_as("t.vtk"), "tetrahedra");
}

}  // namespace
