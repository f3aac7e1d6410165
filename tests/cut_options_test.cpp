// SPDX-License-Identifier: BSD-3-Clause
//
// Clipping and bodies as a user asks for them: `cellproj render --clip --clip-box --surface`.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/voxel_scene_test.hpp"

namespace {

using cellproj::testing_support::Outcome;
using cellproj::testing_support::Pixel;

// The voxels are a cube 0 .. 2, seen along z from below; a square in it stands across the view.
class CutOptions : public cellproj::testing_support::VoxelSceneTest {
protected:
    void SetUp() override {
        VoxelSceneTest::SetUp();
        for (const std::string name : {"square.off", "a:b.off"})
            write(name, "OFF\n4 1 0\n0 0 .5\n2 0 .5\n2 2 .5\n0 2 .5\n4 0 1 2 3\n");
    }
};

const Pixel red{217, 26, 26}, gray{178, 178, 178};  // .85 .1 .1, .7

// The medium in front cut away, a body that faces its headlight has just its own colour.
TEST_F(CutOptions, BodiesHaveTheirColour) {
    const std::string clip = " --clip 0,0,1:0,0,1";
    for (const std::string backend : {" --backend cpu", " --backend gl"}) {
        EXPECT_EQ(seen("--surface square.off" + clip + backend), gray);
        EXPECT_EQ(seen("--surface square.off:red" + clip + backend), red);
        EXPECT_EQ(seen("--surface a:b.off" + clip + backend), gray);
        EXPECT_EQ(seen("--surface a:b.off:0.85,.1,.1" + clip + backend), red);
        EXPECT_EQ(seen("--surface square.off:#808080 --light 1,0,0" + clip + backend), (Pixel{13, 13, 13}));  // along it: ambient light, a tenth
    }
}

// A ray may keep what is before the plane, what is behind it, or both.
TEST_F(CutOptions, PlanesAndBoxesCut) {
    const Pixel whole = seen("--as tets"), white{255, 255, 255};
    const std::string dense = "--opacity-scale 1000 --background 1,1,1 ";
    EXPECT_NE(seen("--clip 0,0,1:0,0,1"), whole);
    EXPECT_EQ(seen("--clip 0,0,-1:0,0,5"), whole);          // keeps all
    EXPECT_EQ(seen("--clip-box -1,-1,-1,3,3,3"), whole);
    EXPECT_EQ(seen(dense + "--clip 0.5,0,0:-1,0,0"), white);  // beside the ray in the middle
    EXPECT_EQ(seen(dense + "--clip-box 0,0,0,0.5,2,2"), white);
    EXPECT_NE(seen(dense + "--clip 0.5,0,0:1,0,0"), white);
    EXPECT_EQ(seen("--clip 0,0,1:0,0,1 --clip 0,0,1.5:0,0,-1"), seen("--clip-box -9,-9,1,9,9,1.5"));
}

// Of radius 1 about the origin, which is a corner of the voxels.
TEST_F(CutOptions, TheSphereOfTheDemoIsABody) {
    const std::string box = " --clip-box 1.9,1.9,1.9,2,2,2";
    EXPECT_EQ(seen("--surface demo:sphere:red" + box), (Pixel{255, 255, 255}));  // the middle is 1.4 from its axis
    EXPECT_EQ(run("--surface demo:sphere" + box).code, 0);
}

TEST_F(CutOptions, ArePutDownInThePicture) {
    EXPECT_EQ(run("--clip 0,0,1:0,0,1 --surface square.off:red").code, 0);
    EXPECT_NE(content("p.png").find("--clip 0,0,1:0,0,1 --surface square.off:red"), std::string::npos);
}

TEST_F(CutOptions, WhatCannotBeUnderstoodIsRefused) {
    expect_refused("--clip 0,0,1", {"--clip", "X,Y,Z:NX,NY,NZ", "\"0,0,1\""});
    expect_refused("--clip 0,0,1:0,0", {"--clip"});
    expect_refused("--clip 0,0,1:0,0,nan", {"--clip"});
    expect_refused("--clip 0,0,1:0,0,0", {"--clip", "a length"});
    expect_refused("--clip-box 0,0,0,1,1", {"--clip-box", "six"});
    expect_refused("--clip-box 0,0,0,1,-1,1", {"--clip-box", "lowest corner first"});
    expect_refused("--clip 0,0,3:0,0,1", {"--clip", "nothing of it", "0,0,0,2,2,2"});
    expect_refused("--clip-box 3,3,3,4,4,4", {"--clip-box", "nothing of it"});
    expect_refused("--clip 0,0,.5:0,0,-1 --clip 0,0,1.5:0,0,1", {"--clip", "nothing of it"});
    expect_refused("--surface square.off:mauve", {"--surface", "\"mauve\"", "#RRGGBB"});
    expect_refused("--surface nowhere.off", {"nowhere.off"});
    expect_refused("--surface v.raw", {"v.raw"});
    write("empty.off", "OFF\n4 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    expect_refused("--surface empty.off", {"empty.off"});
    expect_refused("--light 1,0,0", {"--light", "--surface"});
    expect_refused("--clip 0,0,1:0,0,1 --method shirley-tuchman", {"--method", "integral"});
}

}  // namespace
