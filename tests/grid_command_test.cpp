// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids as a user draws them: `cellproj render` of voxels, images and rectilinear grids.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/folder_test.hpp"

namespace grid_command_test {

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
    for (const char* option : {"--iso 20 --iso-method table", "--order mpvo", "--cell-values averaged", "--verify-order"}) {
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

TEST_F(GridCommand, ItsVolumeIsLit) {
    for (const char* option : {"", "--shading flat --light 1,0,0", "--iso 20:red:0.5", "--clip 1,1,1:0,0,1 --method exact:1e-4 --as grid"})
        EXPECT_EQ(drawn_as(std::string(voxels) + " --shade-volume " + option), "grid") << option;
    EXPECT_NE(content("p.png").find("--shade-volume --shading smooth"), std::string::npos);
    const Outcome explained = run(std::string(voxels) + " --shade-volume --explain");
    for (const char* words : {"of all points", "the medium is lit by them", "rays walk"})
        EXPECT_NE(explained.text.find(words), std::string::npos) << explained.text;
    EXPECT_EQ(run_program(folder_, std::string("render --size 36x30 -o p.png --stats s.json --shade-volume --max-error 0.01 ") + voxels).code, 0);
    EXPECT_LE(nlohmann::json::parse(content("s.json")).at("pictures").at(0).at("error"), 0.01);
    EXPECT_EQ(run_program(folder_, std::string("trade --shade-volume --size 30x30 --rounds 1 --json t.json --backend cpu --method integral ") + voxels).code, 0);
    const auto ways = nlohmann::json::parse(content("t.json"));  // named: a loop does not keep what .at() refers into
    for (const auto& row : ways.at("methods"))  // as it is, and as tetrahedra: the field is linear
        EXPECT_LT(row.at("error").at("color").at("maximum"), 0.01) << row;
    for (const char* option : {"--backend gl", "--sampling object:8 --iso 20:red:0.5", "--sampling view:9:post:x2 --shading flat"})
        EXPECT_EQ(drawn_as(std::string(voxels) + " --shade-volume " + option), "grid") << option;
    std::filesystem::remove(folder_ / "p.png");
    expect_refused(std::string(voxels) + " --shade-volume --backend gl --as grid --method homogeneous:vertices", {"--method", "lit media"});
    expect_refused(std::string(voxels) + " --shade-volume --as grid --method average:half", {"--method", "lit media"});
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

// Few pixels: the judge takes longest.
TEST_F(GridCommand, ABoundChoosesAWayAndExplainTellsIt) {
    const auto render = [&](const std::string& options) {
        return run_program(folder_, std::string("render --size 36x30 -o p.png --stats s.json ") + voxels + " " + options);
    };
    const auto picture = [&] { return nlohmann::json::parse(content("s.json")).at("pictures").at(0); };
    const Outcome outcome = render("--max-error 0.01 --explain");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    for (const char* words : {"--max-error 0.01: ", "  cells, integral", "  the fastest within it", "  order  ", "rays meet their cells", "  segments  "})
        EXPECT_NE(outcome.text.find(words), std::string::npos) << "no \"" << words << "\" in: " << outcome.text;
    EXPECT_LE(picture().at("error"), 0.01);
    EXPECT_EQ(picture().at("drawn_as"), "grid");
    EXPECT_EQ(render("--max-error 0.5 --backend gl --sampling object:12").code, 0);
    EXPECT_EQ(picture().at("drawn_as"), "grid");
    const Outcome never = render("--max-error 1e-9 --backend gl --sampling object:2:pre");
    EXPECT_EQ(never.code, 0);
    EXPECT_NE(never.text.find("warning: no method was within"), std::string::npos) << never.text;
}

TEST_F(GridCommand, ABoundHoldsForWhatIsCut) {
    for (const char* cuts : {"--clip 2,2,2:1,2,3 --caps", "--slice 2,2,2:3,2,1 --volume --surface demo:sphere"}) {
        const Outcome outcome = run_program(folder_, std::string("render --size 24x20 -o p.png --stats s.json --max-error 0.01 ") + voxels + " " + cuts);
        ASSERT_EQ(outcome.code, 0) << outcome.text;
        const auto picture = nlohmann::json::parse(content("s.json")).at("pictures").at(0);
        EXPECT_LE(picture.at("error"), 0.01) << cuts;
        EXPECT_EQ(picture.at("drawn_as"), "grid") << cuts;
    }
}

// One table of all that draws the grid: rays, OpenGL's cells and slabs, and the tetrahedra it is cut into.
TEST_F(GridCommand, TradeMeasuresEveryWaySideBySide) {
    const auto trade = [&](const std::string& options) { return run_program(folder_, std::string("trade ") + voxels + " --size 30x30 --rounds 1 --json t.json " + options); };
    const auto ways = [&] {
        std::vector<std::string> found;
        const auto json = nlohmann::json::parse(content("t.json"));
        for (const auto& row : json.at("methods")) {
            const std::string cut = row.at("sampling").is_null() ? row.at("drawn_as").get<std::string>() : row.at("sampling").get<std::string>();
            found.push_back(cut + " " + row.at("method").get<std::string>() + " " + row.at("backend").get<std::string>());
            EXPECT_LT(row.at("error").at("color").at("maximum"), 0.5) << found.back();
        }
        return found;
    };
    const Outcome all = trade("-o t.html --csv t.csv");
    ASSERT_EQ(all.code, 0) << all.text;
    const std::vector<std::string> found = ways();
    for (const char* way : {"cells integral cpu", "cells exact:1e-05 cpu", "cells integral gl_osmesa", "cells homogeneous:vertices gl_osmesa",
                            "object:5:post integral gl_osmesa", "view:20 integral gl_osmesa", "tetrahedra integral cpu"})
        EXPECT_EQ(std::count(found.begin(), found.end(), way), 1) << way;
    EXPECT_NE(all.text.find("tets, integral"), std::string::npos) << all.text;
    EXPECT_NE(content("t.csv").find(",grid,object:5:post\n"), std::string::npos);
    EXPECT_NE(content("t.html").find("<td>cells, integral<td>cpu"), std::string::npos);

    ASSERT_EQ(trade("--sampling object:9 --sampling view:9").code, 0);
    EXPECT_EQ(ways().size(), 2U);
    ASSERT_EQ(trade("--backend cpu --method integral").code, 0);
    EXPECT_EQ(ways().size(), 2U);  // as it is, and as tetrahedra
    for (const auto& [options, words] : std::initializer_list<std::pair<const char*, const char*>>{
             {"--backend cpu --sampling object:9", "--backend gl"}, {"--as tets --sampling object:9", "--sampling"},
             {"--method exact --sampling object:9", "--method"}, {"--sampling slabs:9", "object:N"}}) {
        const Outcome refused = trade(options);
        EXPECT_EQ(refused.code, 1) << options;
        EXPECT_NE(refused.text.find(words), std::string::npos) << options << ": " << refused.text;
    }
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
