// SPDX-License-Identifier: BSD-3-Clause
//
// Hierarchies of grids as a user gives them: JSON that names the pieces, VTK's AMR; in `info`, `render` and `trade`.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/folder_test.hpp"

namespace hierarchy_command_test {

using cellproj::testing_support::FolderTest;
using cellproj::testing_support::Outcome;
using cellproj::testing_support::run_program;

class HierarchyCommand : public FolderTest {
protected:
    // A cube of 4 cells along each axis, a corner of it refined 2:1.
    void SetUp() override {
        FolderTest::SetUp();
        write("coarse.vti", image("0 0 0", "1", 4));
        write("fine.vti", image("0 0 0", "0.5", 4));
        write("two.json", R"({"pieces": ["coarse.vti", {"file": "fine.vti"}]})");
    }

    // An image of n cells along each axis, with x + 2y + 3z on points and the number of the cell on cells.
    static std::string image(const std::string& origin, const std::string& h, int n, const std::string& name = "s") {
        const double step = std::stod(h), x0 = std::stod(origin);
        std::string values, cells;
        for (int k = 0; k <= n; ++k)
            for (int j = 0; j <= n; ++j)
                for (int i = 0; i <= n; ++i) values += std::to_string(x0 + step * (i + 2 * j + 3 * k)) + " ";
        for (int c = 0; c < n * n * n; ++c) cells += std::to_string(c) + " ";
        const std::string extent = "0 " + std::to_string(n) + " 0 " + std::to_string(n) + " 0 " + std::to_string(n);
        const auto array = [](const std::string& of, const std::string& numbers) {
            return "<DataArray type=\"Float64\" Name=\"" + of + "\" format=\"ascii\">" + numbers + "</DataArray>";
        };
        return "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"" + extent + "\" Origin=\"" + origin +
               "\" Spacing=\"" + h + " " + h + " " + h + "\"><Piece Extent=\"" + extent + "\"><PointData>" + array(name, values) + "</PointData><CellData>" +
               array("c", cells) + "</CellData></Piece></ImageData></VTKFile>";
    }

    // The same two as VTK's overlapping AMR.
    void write_amr() const {
        std::filesystem::create_directory(folder_ / "amr");
        write("amr/0.vti", image("0 0 0", "1", 4));
        write("amr/1.vti", image("0 0 0", "0.5", 4));
        write("amr.vth", R"(<?xml version="1.0"?>
<VTKFile type="vtkOverlappingAMR" version="1.1" byte_order="LittleEndian" header_type="UInt32">
  <vtkOverlappingAMR origin="0 0 0" grid_description="XYZ">
    <Block level="0" spacing="1 1 1"><DataSet index="0" amr_box="0 3 0 3 0 3" file="amr/0.vti"></DataSet></Block>
    <Block level="1" spacing="0.5 0.5 0.5"><DataSet index="0" amr_box="0 3 0 3 0 3" file="amr/1.vti"></DataSet></Block>
  </vtkOverlappingAMR>
</VTKFile>
)");
    }

    Outcome render(const std::string& options) const { return run_program(folder_, "render --size 40x36 -o p.png --stats s.json " + options); }

    nlohmann::json picture() const { return nlohmann::json::parse(content("s.json")).at("pictures").at(0); }

    void expect_refused(const std::string& arguments, std::initializer_list<const char*> words) const {
        const Outcome outcome = run_program(folder_, arguments);
        EXPECT_EQ(outcome.code, 1) << arguments << "\n" << outcome.text;
        for (const char* word : words) EXPECT_NE(outcome.text.find(word), std::string::npos) << "no \"" << word << "\" in: " << outcome.text;
    }
};

TEST_F(HierarchyCommand, InfoTellsLevelsPiecesAndVisibleCells) {
    write_amr();
    for (const char* file : {"two.json", "amr.vth"}) {
        const Outcome outcome = run_program(folder_, std::string("info ") + file);
        ASSERT_EQ(outcome.code, 0) << outcome.text;
        for (const char* words : {"2 pieces, 2 levels", "cells       120 hexahedra (8 more are under finer ones", "hierarchy   2 levels, 2 pieces",
                                  "level 0   spacing 1x1x1, 1 pieces, 56 of 64 cells visible", "level 1   spacing 0.5x0.5x0.5, 1 pieces, 64 of 64 cells visible",
                                  "volume      64"})
            EXPECT_NE(outcome.text.find(words), std::string::npos) << "no \"" << words << "\" in: " << outcome.text;
    }
}

TEST_F(HierarchyCommand, RenderDrawsThePiecesAsTheyAre) {
    write_amr();
    for (const char* options : {"two.json", "amr.vth --projection parallel", "two.json --field c", "two.json --as grid --method exact:1e-4 --outline"}) {
        const Outcome outcome = render(std::string(options) + " --explain");
        ASSERT_EQ(outcome.code, 0) << outcome.text;
        EXPECT_EQ(picture().at("drawn_as"), "grid") << options;
        EXPECT_EQ(picture().at("backend"), "cpu");
        EXPECT_EQ(picture().at("counts").at("cells"), 120);
        EXPECT_NE(outcome.text.find("2 in 2 levels"), std::string::npos) << outcome.text;
    }
    // The rest is drawn as tetrahedra, unless they are ruled out.
    for (const char* options : {"two.json --backend gl", "two.json --iso 4", "two.json --shade-volume", "two.json --as tets", "amr.vth --order mpvo"}) {
        ASSERT_EQ(render(options).code, 0) << options;
        EXPECT_EQ(picture().at("drawn_as"), "tetrahedra") << options;
    }
    for (const char* options : {"--backend gl", "--iso 4", "--shade-volume"})
        expect_refused(std::string("render two.json -o q.png --as grid ") + options, {"hierarchy of grids", "--as tets"});
    expect_refused("render two.json -o q.png --sampling object:9", {"--sampling", "hierarchy of grids"});
}

// The field is linear: both ways are exact, whatever the method.
TEST_F(HierarchyCommand, TradeAndMaxErrorMeasureIt) {
    const Outcome trade = run_program(folder_, "trade two.json --size 30x30 --rounds 1 --method integral --method exact:1e-4 --json t.json");
    ASSERT_EQ(trade.code, 0) << trade.text;
    const auto json = nlohmann::json::parse(content("t.json"));
    ASSERT_EQ(json.at("methods").size(), 4U);
    for (const auto& row : json.at("methods")) EXPECT_LT(row.at("error").at("color").at("maximum"), 1e-4) << row;
    const Outcome bound = render("two.json --max-error 0.01");
    ASSERT_EQ(bound.code, 0) << bound.text;
    EXPECT_NE(bound.text.find("the fastest within it"), std::string::npos);
    EXPECT_LE(picture().at("error"), 0.01);
}

TEST_F(HierarchyCommand, BadFilesAreToldByTheirPlace) {
    const auto refused = [&](const std::string& json, std::initializer_list<const char*> words) {
        write("bad.json", json);
        expect_refused("render bad.json -o q.png", words);
    };
    refused(R"({"pieces": ["coarse.vti", "none.vti"]})", {"bad.json", "none.vti", "none of that name"});
    refused(R"({"pieces": ["coarse.vti", "bad.json"]})", {"piece bad.json", "a hierarchy"});
    refused(R"({"pieces": []})", {"pieces", "an array of files"});
    refused(R"({"pieces": [7]})", {"pieces[0]", "the name of a file"});
    refused(R"({"pieces": ["coarse.vti"], "piecs": 1})", {"\"piecs\"", "pieces"});
    refused(R"({"pieces": [{"file": "coarse.vti", "spacing": [1,1,1]}]})", {"pieces[0]", "\"spacing\""});
    refused(R"({"pieces": ["coarse.vti", )", {"bad.json", "JSON"});
    refused(R"({"pieces": [{"file": "v.raw", "dims": [2,2]}]})", {"dims", "three numbers"});
    write("v.raw", std::string(27, '1'));
    refused(R"({"pieces": [{"file": "v.raw", "dims": [3,3,3]}]})", {"\"type\""});
    refused(R"({"pieces": [{"file": "v.raw", "dims": [3,3,3], "type": "uint9"}]})", {"type", "did you mean", "uint8"});
    refused(R"({"pieces": [{"file": "v.raw", "dims": [3,3,4], "type": "uint8"}]})", {"v.raw", "36 bytes", "27 bytes"});
    refused(R"({"pieces": ["coarse.vti", {"file": "v.raw", "dims": [3,3,3], "type": "uint8"}]})", {"v.raw", "the field \"s\" on points"});
    write("moved.vti", image("0.2 0.2 0.2", "0.5", 4));
    refused(R"({"pieces": ["coarse.vti", "moved.vti"]})", {"piece moved.vti, axis x", "check origin and spacing"});
    write("same.vti", image("2 2 2", "1", 4));
    refused(R"({"pieces": ["coarse.vti", "same.vti"]})", {"piece same.vti", "an overlap with piece coarse.vti in 2 .. 4"});
    write("part.vti", image("0.5 0.5 0.5", "0.5", 2));
    refused(R"({"pieces": ["coarse.vti", "part.vti"]})", {"piece coarse.vti, cell 0", "a part of it"});
    write("other.vti", image("0 0 0", "0.5", 4, "q"));
    refused(R"({"pieces": ["coarse.vti", "other.vti"]})", {"piece other.vti", "the field \"s\" on points, as piece coarse.vti has it"});
    write("t.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n");
    refused(R"({"pieces": ["coarse.vti", "t.vtk"]})", {"piece t.vtk", "a grid of boxes"});
    write_amr();
    std::filesystem::remove(folder_ / "amr/1.vti");
    expect_refused("render amr.vth -o q.png", {"amr.vth"});
    EXPECT_FALSE(std::filesystem::exists(folder_ / "q.png"));
}

// Bare voxels in either byte order, beside any other format.
TEST_F(HierarchyCommand, PiecesMayBeBareVoxels) {
    std::string big;
    for (int i = 0; i < 27; ++i) big += std::string(1, '\0') + static_cast<char>(i);
    write("b.raw", "head" + big);
    std::string small;
    for (int i = 0; i < 27; ++i) small += static_cast<char>(i);
    write("s.raw", small);
    write("raw.json", R"({"pieces": [{"file": "b.raw", "dims": [3,3,3], "type": "uint16", "big_endian": true, "header": 4, "spacing": [2,2,2], "origin": [0,0,0]},
                                      {"file": "s.raw", "dims": [3,3,3], "type": "uint8", "origin": [2,2,2]}]})");
    const Outcome outcome = run_program(folder_, "info raw.json");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_NE(outcome.text.find("on points, 0 .. 26"), std::string::npos) << outcome.text;
    EXPECT_NE(outcome.text.find("7 of 8 cells visible"), std::string::npos) << outcome.text;
    EXPECT_EQ(render("raw.json").code, 0);
}

}  // namespace
