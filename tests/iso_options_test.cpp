// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces as a user asks for them: `cellproj render --iso`.
#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/voxel_scene_test.hpp"

namespace iso_options_test {

using cellproj::testing_support::Outcome;
using cellproj::testing_support::Pixel;
using cellproj::testing_support::run_program;

class IsoOptions : public cellproj::testing_support::VoxelSceneTest {};

// Facing its headlight a surface has just its own colour.
TEST_F(IsoOptions, ColorsAndOpacities) {
    EXPECT_EQ(seen("--iso 5:white"), (Pixel{255, 255, 255}));
    EXPECT_EQ(seen("--iso 5:#4080c0"), (Pixel{0x40, 0x80, 0xc0}));
    EXPECT_EQ(seen("--iso 5:1,0.2,0"), (Pixel{255, 51, 0}));
    EXPECT_EQ(seen("--iso 5:black:0.6"), (Pixel{102, 102, 102}));         // over white
    EXPECT_EQ(seen("--iso 5:1,0,0:0.6 --background 0,0,0"), (Pixel{153, 0, 0}));
    EXPECT_EQ(seen("--iso 5,6,7:1,0,0:0.6 --background 0,0,0"), (Pixel{239, 0, 0}));  // 1 − .4³
    EXPECT_EQ(seen("--iso 5:0,0,1 --iso 15:1,0,0"), (Pixel{255, 0, 0}));              // 15 is in front
    EXPECT_EQ(seen("--iso 5:0,0,1 --iso 15:1,0,0:0.2 --background 0,0,0"), (Pixel{51, 0, 204}));
}

TEST_F(IsoOptions, ColorsComeFromTheTransferFunction) {
    write("t.json", R"({"color": [[0, 0, 0, 1], [20, 1, 0, 0]], "extinction": [[0, 0], [20, 0]]})");
    EXPECT_EQ(seen("--iso 5 --transfer t.json"), (Pixel{64, 0, 191}));
    const Pixel viridis = seen("--iso 20 --range 0,20");  // its yellow end
    EXPECT_GT(viridis[1], 200);
    EXPECT_LT(viridis[2], 80);
    EXPECT_EQ(seen("--iso 20 --range 0,20 --colors gray"), (Pixel{255, 255, 255}));
}

TEST_F(IsoOptions, TheVolumeIsDrawnOnDemand) {
    const Pixel alone = seen("--iso 5:0,0,0");
    EXPECT_EQ(alone, (Pixel{0, 0, 0}));
    const Pixel with_volume = seen("--iso 5:0,0,0 --volume");
    EXPECT_NE(with_volume, alone);
    EXPECT_EQ(seen("--iso 5:0,0,0 --opacity-scale 1"), with_volume);
    EXPECT_NE(seen("--volume --iso 5:0,0,0 --opacity-scale 5"), with_volume);
}

TEST_F(IsoOptions, ShadingAndLight) {
    EXPECT_EQ(seen("--iso 5:#808080 --shading unlit --light 1,0,0"), (Pixel{0x80, 0x80, 0x80}));
    for (const char* shading : {"flat", "smooth"}) {
        const std::string with = std::string("--iso 5:#ffffff --shading ") + shading;
        EXPECT_EQ(seen(with + " --light 0,0,-3"), (Pixel{255, 255, 255}));
        EXPECT_EQ(seen(with + " --light 0,0,1"), (Pixel{26, 26, 26}));  // from behind: ambient light, a tenth
        const Pixel slant = seen(with + " --light 1,0,-1");
        EXPECT_GT(slant[0], 26 + 100);
        EXPECT_LT(slant[0], 240);
    }
    EXPECT_EQ(run("--iso 5 --shading round").code, 2);
    EXPECT_EQ(run("--shading flat").code, 2);
    // Ambient light is white, a tenth; the rest of each light has its colour.
    EXPECT_EQ(seen("--iso 5:#ffffff --light 0,0,-3:1,0,0 --light eye:0,0,1"), (Pixel{255, 26, 255}));
    EXPECT_EQ(seen("--iso 5:#ffffff --light 0,0,1:red --light eye:0,0.5,0"), (Pixel{26, 140, 26}));
    EXPECT_NE(content("p.png").find("--light 0,0,1:red --light eye:0,0.5,0"), std::string::npos);
    EXPECT_EQ(run("--volume").code, 2);
}

// The volume alone, or around surfaces; a headlight shows what faces it in its own colour, and light from behind a tenth of it.
TEST_F(IsoOptions, TheVolumeIsLitOnDemand) {
    const Pixel unlit = seen("--opacity-scale 1");
    const Pixel facing = seen("--shade-volume --light 0,0,-3"), behind = seen("--shade-volume --shading flat --light 0,0,1");
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(facing[k], unlit[k], 1);
        EXPECT_LE(behind[k], unlit[k]);
    }
    EXPECT_NE(behind, unlit);
    EXPECT_NE(seen("--iso 5:0,0,0:0.5 --shade-volume --light 0,0,1"), seen("--iso 5:0,0,0:0.5 --volume --light 0,0,1"));
    EXPECT_NE(content("p.png").find("cellproj isosurfaces"), std::string::npos);
    ASSERT_EQ(run("--shade-volume --explain").code, 0);
    EXPECT_NE(content("p.png").find("--shade-volume --shading smooth"), std::string::npos);
    EXPECT_EQ(run("--shade-volume --shading unlit").code, 2);
    EXPECT_EQ(run("--shade-volume --method shirley-tuchman").code, 1);
}

TEST_F(IsoOptions, AreToldInTheStatisticsAndThePicture) {
    ASSERT_EQ(run("--iso 5,15 --stats s.json").code, 0);
    const auto json = nlohmann::json::parse(content("s.json")).at("pictures").at(0);
    EXPECT_EQ(json.at("order"), "none");  // opaque surfaces alone
    EXPECT_EQ(json.at("backend"), "cpu");
    EXPECT_NE(content("p.png").find("--iso 5,15 --shading smooth"), std::string::npos);
    ASSERT_EQ(run("--iso 5::0.5 --order pixel --stats s.json").code, 0);
    EXPECT_EQ(nlohmann::json::parse(content("s.json")).at("pictures").at(0).at("order"), "pixel");
    ASSERT_EQ(run("--iso 5::0.5 --verify-order").code, 0);
    ASSERT_EQ(run("--iso 5::0.5 --volume --max-error 0.01").code, 0);
}

TEST_F(IsoOptions, WrongOnesAreRefusedByName) {
    expect_refused("--iso nan", {"--iso", "\"nan\"", "finite"});
    expect_refused("--iso 5,,6", {"--iso", "isovalues"});
    expect_refused("--iso ''", {"--iso"});
    expect_refused("--iso 5:mauve", {"--iso", "\"mauve\"", "orange", "#RRGGBB"});
    expect_refused("--iso 5:#12345", {"#12345"});
    expect_refused("--iso 5:#12345g", {"#12345g"});
    expect_refused("--iso 5:2,0,0", {"2,0,0"});
    expect_refused("--iso 5:red:1.5", {"\"1.5\"", "0..1"});
    expect_refused("--iso 5:red:1:2", {"--iso again"});
    expect_refused("--iso 5 --iso 6,5", {"--iso", "5", "twice"});
    expect_refused("--iso 5 --light 0,0,0", {"--light"});
    expect_refused("--iso 5 --light 1,2", {"--light", "\"1,2\"", "eye"});
    expect_refused("--iso 5 --light nowhere", {"--light", "\"nowhere\""});
    expect_refused("--iso 5 --light 1,2,3:mauve", {"--light", "\"mauve\"", "#RRGGBB"});
    expect_refused("--iso 5 --light 1,2,3:red:2", {"--light", "again"});
}

TEST_F(IsoOptions, ValuesWithoutASurfaceAreNotSilent) {
    const Outcome outside = run("--iso 21");
    EXPECT_EQ(outside.code, 0);
    EXPECT_NE(outside.text.find("--iso 21"), std::string::npos) << outside.text;
    EXPECT_NE(outside.text.find("0 .. 20"), std::string::npos) << outside.text;
    EXPECT_NE(run("--iso 0").text.find("nowhere below"), std::string::npos);
    EXPECT_EQ(run("--iso 20").text.find("warning"), std::string::npos);
    EXPECT_EQ(run("--iso -3,5").code, 0);
}

TEST_F(IsoOptions, CellFieldsWantToBeAveraged) {
    write("c.vtk", "# vtk DataFile Version 3.0\nc\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
                   "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n"
                   "CELL_DATA 2\nSCALARS rank double 1\nLOOKUP_TABLE default\n0 4\n");
    const Outcome outcome = run_program(folder_, "render c.vtk -o c.png --size 20x20 --iso 2");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.text.find("--cell-values averaged"), std::string::npos) << outcome.text;
    EXPECT_EQ(run_program(folder_, "render c.vtk -o c.png --size 20x20 --iso 2 --cell-values averaged").code, 0);
}

}  // namespace
