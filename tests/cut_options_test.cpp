// SPDX-License-Identifier: BSD-3-Clause
//
// Clipping, bodies and slices as a user asks for them: `cellproj render --clip --clip-box --surface --slice --caps`.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/voxel_scene_test.hpp"

namespace cut_options_test {

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
    const Pixel whole = seen(""), white{255, 255, 255};
    const std::string dense = "--opacity-scale 1000 --background 1,1,1 ";
    EXPECT_NE(seen("--clip 0,0,1:0,0,1"), whole);
    EXPECT_EQ(seen("--clip 0,0,-1:0,0,5"), whole);          // keeps all
    EXPECT_EQ(seen("--clip-box -1,-1,-1,3,3,3"), whole);
    EXPECT_EQ(seen(dense + "--clip 0.5,0,0:-1,0,0"), white);  // beside the ray in the middle
    EXPECT_EQ(seen(dense + "--clip-box 0,0,0,0.5,2,2"), white);
    EXPECT_NE(seen(dense + "--clip 0.5,0,0:1,0,0"), white);
    EXPECT_EQ(seen("--clip 0,0,1:0,0,1 --clip 0,0,1.5:0,0,-1"), seen("--clip-box -9,-9,1,9,9,1.5"));
}

// The scalar falls from 20 at z = 0 to 0 at z = 2; grays from 0 to 1 over 0 .. 20. A slice hides what is behind it, alone or in the volume.
TEST_F(CutOptions, SlicesAndCapsHaveTheColorsOfTheBar) {
    write("g.json", R"({"color": [[0, 0, 0, 0], [20, 1, 1, 1]], "extinction": [[0, 0], [20, 0]]})");
    const std::string grays = "--transfer g.json ";
    const auto gray_of = [](double s) { return Pixel{static_cast<int>(std::lround(255 * s / 20)), static_cast<int>(std::lround(255 * s / 20)), static_cast<int>(std::lround(255 * s / 20))}; };
    for (const std::string backend : {" --backend cpu", " --backend gl", " --as tets", " --as tets --backend gl"}) {
        EXPECT_EQ(seen(grays + "--slice 0,0,0.7:0,0,1" + backend), gray_of(13)) << backend;
        EXPECT_EQ(seen(grays + "--slice 0,0,1.5:0,0,-3 --slice 0,0,1.1:0,0,1" + backend), gray_of(9)) << backend;
        EXPECT_EQ(seen(grays + "--slice 1,1,0.5:1,0,1" + backend), gray_of(15)) << backend;
        EXPECT_EQ(seen(grays + "--clip 0,0,0.7:0,0,1 --caps" + backend), gray_of(13)) << backend;
        EXPECT_EQ(seen(grays + "--clip-box 0,0,0.9,2,2,1.5 --caps" + backend), gray_of(11)) << backend;
        EXPECT_EQ(seen(grays + "--slice 0,0,0.7:0,0,1 --clip 0,0,1:0,0,1" + backend), (Pixel{255, 255, 255})) << backend;  // cut away
        // The volume comes before the slice where it is asked for.
        EXPECT_EQ(seen("--slice 0,0,2:0,0,1 --volume" + backend), seen("--slice 0,0,2:0,0,1 --opacity-scale 1" + backend));
        EXPECT_NE(seen("--slice 0,0,2:0,0,1 --volume" + backend), seen("--slice 0,0,2:0,0,1" + backend));
    }
    EXPECT_NE(run("--slice 0,0,1:0,0,1 --explain --as tets").text.find("none: 1 slice alone"), std::string::npos);
    EXPECT_NE(run("--slice 0,0,1:0,0,1 --explain --volume").text.find("1 slice: a part of each ray is left"), std::string::npos);
    for (const std::string as : {"grid", "tets"}) {
        const Outcome beside = run("--slice 0,0,2.1:0,0,1 --as " + as);
        EXPECT_EQ(beside.code, 0) << beside.text;
        EXPECT_NE(beside.text.find("--slice 0,0,2.1:0,0,1: nothing of the mesh is in this plane; the mesh lies in 0,0,0,2,2,2"), std::string::npos) << beside.text;
        EXPECT_EQ(middle_of("p.png"), (Pixel{255, 255, 255}));
    }
}

// Of radius 1 about the origin, which is a corner of the voxels.
TEST_F(CutOptions, TheSphereOfTheDemoIsABody) {
    const std::string box = " --clip-box 1.9,1.9,1.9,2,2,2";
    EXPECT_EQ(seen("--surface demo:sphere:red" + box), (Pixel{255, 255, 255}));  // the middle is 1.4 from its axis
    EXPECT_EQ(run("--surface demo:sphere" + box).code, 0);
}

TEST_F(CutOptions, ArePutDownInThePicture) {
    EXPECT_EQ(run("--clip 0,0,1:0,0,1 --surface square.off:red --slice 1,1,1:1,0,0 --caps").code, 0);
    EXPECT_NE(content("p.png").find("--clip 0,0,1:0,0,1 --caps --slice 1,1,1:1,0,0 --surface square.off:red"), std::string::npos);
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
    expect_refused("--slice 0,0,1", {"--slice", "X,Y,Z:NX,NY,NZ", "\"0,0,1\""});
    expect_refused("--slice 0,0,1:0,0,nan", {"--slice"});
    expect_refused("--slice 0,0,1:0,0,0", {"--slice", "a length"});
    expect_refused("--caps", {"--caps", "--clip"});
}

}  // namespace
