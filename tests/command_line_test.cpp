// SPDX-License-Identifier: BSD-3-Clause
//
// The program as a user meets it: exit codes, messages, files. Meshes are small files written here.
#include <limits>
#include <cstring>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <nlohmann/json.hpp>

#include "render/renderer.hpp"
#include "tests/support/folder_test.hpp"

namespace command_line_test {

namespace fs = std::filesystem;
using cellproj::testing_support::FolderTest;
using cellproj::testing_support::Outcome;
using cellproj::testing_support::run_program;

class CommandLine : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        write("cube.vtk", cube());
    }

    fs::path path(const std::string& name) const { return folder_ / name; }

    // Runs cellproj in the test's folder.
    Outcome run(const std::string& arguments, const std::string& environment = "") const {
        return run_program(folder_, arguments, environment);
    }

    // Exit 1, the words in the message, and no picture or leftover in the folder.
    void expect_refused(const std::string& arguments, std::initializer_list<const char*> words) const {
        const auto files = [&] { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); };
        const auto before = files();
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, 1) << arguments << "\n" << outcome.text;
        for (const char* word : words) {
            EXPECT_NE(outcome.text.find(word), std::string::npos) << "no \"" << word << "\" in: " << outcome.text;
        }
        EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << "one line only: " << outcome.text;
        EXPECT_EQ(files(), before) << arguments;
    }

    // One hexahedron with a scalar "p", a vector "U" and a cell field "rank".
    static std::string cube() {
        return "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
               "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n"
               "POINT_DATA 8\nSCALARS p double 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\nVECTORS U double\n"
               "0 0 0 1 0 0 0 2 0 0 0 3 0 0 0 3 4 0 0 0 0 0 0 0\nCELL_DATA 1\nSCALARS rank int 1\nLOOKUP_TABLE default\n7\n";
    }

    static std::string replaced(std::string text, const std::string& what, const std::string& with) {
        const auto at = text.find(what);
        EXPECT_NE(at, std::string::npos);
        return text.replace(at, what.size(), with);
    }
};

TEST_F(CommandLine, RendersAPicture) {
    const Outcome outcome = run("render cube.vtk -o cube.png --size 40x30");
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_GT(fs::file_size(path("cube.png")), 200U);
    EXPECT_EQ(run("render cube.vtk -o cube.exr --size 40x30 --field U --projection parallel").code, 0);
    EXPECT_TRUE(fs::exists(path("cube.exr")));
}

TEST_F(CommandLine, StatisticsHaveTheirKeys) {
    ASSERT_EQ(run("render cube.vtk -o cube.png --size 40x30 --stats stats.json").code, 0);
    std::ifstream stream(path("stats.json"));
    const auto json = nlohmann::json::parse(stream);
    const auto& picture = json.at("pictures").at(0);
    EXPECT_EQ(picture.at("counts").at("cells"), 6);
    EXPECT_EQ(picture.at("counts").at("order_violations"), 0);
    for (const char* key : {"plan", "sort", "project", "draw", "read_back", "total", "write"}) {
        EXPECT_GE(picture.at("ms").at(key), 0.0) << key;
    }
    EXPECT_GT(picture.at("ms").at("total"), 0.0);
    EXPECT_GT(json.at("peak_memory_bytes"), 1'000'000);
    EXPECT_EQ(picture.at("backend"), "cpu");
}

TEST_F(CommandLine, TheBackendIsChosenAndTold) {
    const auto backend_of = [&](const std::string& options) {
        const Outcome outcome = run("render cube.vtk -o cube.png --size 20x20 --stats stats.json " + options);
        EXPECT_EQ(outcome.code, 0) << outcome.text;
        std::ifstream stream(path("stats.json"));
        return nlohmann::json::parse(stream).at("pictures").at(0).at("backend").get<std::string>();
    };
    const bool gpu = cellproj::find_gpu().found;
    EXPECT_EQ(backend_of(""), gpu ? "gl_egl" : "cpu");
    EXPECT_EQ(backend_of("--backend cpu --threads 1 --order pixel"), "cpu");
    EXPECT_EQ(backend_of("--backend osmesa"), "gl_osmesa");
    EXPECT_EQ(backend_of("--backend egl"), "gl_egl");
    EXPECT_EQ(backend_of("--backend gl"), gpu ? "gl_egl" : "gl_osmesa");
    EXPECT_EQ(backend_of("--method shirley-tuchman"), gpu ? "gl_egl" : "gl_osmesa");  // which only OpenGL draws
    expect_refused("render cube.vtk -o x.png --backend cpu --method shirley-tuchman", {"--method", "--backend gl"});
    expect_refused("render cube.vtk -o x.png --backend gl --order pixel", {"--order", "--backend cpu"});
    expect_refused("render cube.vtk -o x.png --backend cpu --target rgba8", {"--target", "rgba32f"});
}

TEST_F(CommandLine, ExplainsWhatItChose) {
    const Outcome outcome = run("render cube.vtk -o cube.png --size 20x20 --backend cpu --explain --stats stats.json");
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    std::ifstream stream(path("stats.json"));
    const auto plan = nlohmann::json::parse(stream).at("pictures").at(0).at("plan");
    ASSERT_EQ(plan.at(0).at("rule"), "backend");
    for (const auto& decision : plan)  // every one of them stands on a line of its own
        for (const char* key : {"rule", "chosen", "why"}) EXPECT_NE(outcome.text.find(decision.at(key).get<std::string>()), std::string::npos) << key;
    const Outcome silent = run("render cube.vtk -o cube.png --size 20x20");
    EXPECT_EQ(silent.text.find("backend "), std::string::npos) << silent.text;
    // Pictures that are planned alike are explained once.
    const Outcome turned = run("render cube.vtk -o cube.png --size 20x20 --explain --orbit 90 --frames 3");
    EXPECT_EQ(turned.text.find("  gradients "), turned.text.rfind("  gradients ")) << turned.text;
}

TEST_F(CommandLine, TheOrderIsChosenProvenAndDoubtedAloud) {
    const auto order_of = [&](const std::string& options) {
        const Outcome outcome = run("render cube.vtk -o cube.png --size 40x30 --stats stats.json " + options);
        EXPECT_EQ(outcome.code, 0) << outcome.text;
        std::ifstream stream(path("stats.json"));
        return std::pair(outcome.text, nlohmann::json::parse(stream).at("pictures").at(0));
    };
    const auto [quiet, exact] = order_of("");
    EXPECT_EQ(quiet.find("warning"), std::string::npos) << quiet;
    EXPECT_EQ(exact.at("order_exact"), true);
    EXPECT_TRUE(exact.at("order_check").is_null());

    const auto [doubtful, centroid] = order_of("--order centroid --verify-order");
    EXPECT_NE(doubtful.find("not proven"), std::string::npos) << doubtful;
    EXPECT_NE(doubtful.find("of 1200 rays"), std::string::npos) << doubtful;
    EXPECT_EQ(centroid.at("order"), "centroid");
    EXPECT_EQ(centroid.at("order_exact"), false);

    const auto [told, mpvo] = order_of("--order mpvo --verify-order");
    EXPECT_NE(told.find("order mpvo, exact: 0 face relations violated; 0 of 1200 rays"), std::string::npos) << told;
    EXPECT_EQ(mpvo.at("order_check").at("wrong_rays"), 0);
    EXPECT_EQ(run("render cube.vtk -o cube.png --order best").code, 2);
}

TEST_F(CommandLine, OpacityFromAnotherField) {
    ASSERT_EQ(run("render cube.vtk -o p.png --size 20x20 --field p").code, 0);
    const Outcome outcome = run("render cube.vtk -o two.png --size 20x20 --field p --opacity-field U");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_NE(content("two.png").substr(200), content("p.png").substr(200));
    EXPECT_NE(content("two.png").find("cellproj opacity field"), std::string::npos);
    EXPECT_EQ(run("render cube.vtk -o two.png --size 20x20 --field p --opacity-field rank --max-error .01").code, 0);
    expect_refused("render cube.vtk -o x.png --opacity-field q", {"\"q\"", "p"});
    expect_refused("render cube.vtk -o x.png --opacity-field U --method preint3d:32", {"--method", "preint3d:32", "integral"});
    expect_refused("render cube.vtk -o x.png --opacity-field U --backend cpu", {"--opacity-field", "--backend gl"});
    EXPECT_EQ(run("trade cube.vtk --size 20x20 --rounds 1 --opacity-field U").code, 0);
    expect_refused("trade cube.vtk --opacity-field U --method stein:vertices", {"--method"});
}

TEST_F(CommandLine, MethodAndTargetAreChosenAndTold) {
    const Outcome outcome =
        run("render cube.vtk -o cube.png --size 20x20 --method shirley-tuchman --target rgba16f --stats stats.json");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    std::ifstream stream(path("stats.json"));
    const auto picture = nlohmann::json::parse(stream).at("pictures").at(0);
    EXPECT_EQ(picture.at("method"), "shirley-tuchman");
    EXPECT_EQ(picture.at("target"), "rgba16f");
    expect_refused("render cube.vtk -o x.png --target rgba32", {"--target", "\"rgba32f\""});
    expect_refused("render cube.vtk -o x.png --method linear:half", {"--method", "pixels or vertices"});
}

TEST_F(CommandLine, OrbitAndCameraArraysNumberTheirPictures) {
    EXPECT_EQ(run("render cube.vtk -o orbit.png --size 20x20 --orbit 180 --frames 3").code, 0);
    for (const char* name : {"orbit_000.png", "orbit_001.png", "orbit_002.png"}) EXPECT_TRUE(fs::exists(path(name))) << name;
    EXPECT_FALSE(fs::exists(path("orbit_003.png")));
    const std::string camera = R"({"projection": "parallel", "eye": [3,2,1], "center": [0.5,0.5,0.5], "up": [0,0,1], "height": 2})";
    write("cams.json", "[" + camera + "," + camera + "]");
    EXPECT_EQ(run("render cube.vtk -o two.png --size 20x20 --camera cams.json").code, 0);
    EXPECT_TRUE(fs::exists(path("two_001.png")));
    write("cam.json", camera);
    EXPECT_EQ(run("render cube.vtk -o one.png --size 20x20 --camera cam.json").code, 0);
    EXPECT_TRUE(fs::exists(path("one.png")));
    expect_refused("render cube.vtk -o three.png --camera cams.json --orbit 90 --frames 2", {"--frames", "2 cameras"});
}

TEST_F(CommandLine, InfoTellsWhatIsInAFile) {
    const Outcome outcome = run("info cube.vtk");
    EXPECT_EQ(outcome.code, 0);
    for (const char* words : {"points      8", "1 hexahedr", "tetrahedra  6 (0 of zero volume", "0 .. 7", "3 components, magnitude 0 .. 5",
                              "rank", "cellproj render cube.vtk -o picture.png --field p"}) {
        EXPECT_NE(outcome.text.find(words), std::string::npos) << "no \"" << words << "\" in:\n" << outcome.text;
    }
}

TEST_F(CommandLine, CheckTellsGoodFromBad) {
    const Outcome good = run("check cube.vtk");
    EXPECT_EQ(good.code, 0) << good.text;
    EXPECT_NE(good.text.find("convex, Delaunay"), std::string::npos) << good.text;
    const auto json = nlohmann::json::parse(run("check cube.vtk --json").text);
    EXPECT_EQ(json.at("tetrahedra"), 6);
    EXPECT_EQ(json.at("faithful"), true);
    // Three tetrahedra at one face.
    write("three.vtk", "# vtk DataFile Version 3.0\nthree\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n"
                       "0 0 0 1 0 0 0 1 0 0 0 1 0 0 -1 0 0 2\nCELLS 3 15\n4 0 1 2 3\n4 0 2 1 4\n4 0 1 2 5\nCELL_TYPES 3\n10\n10\n10\n");
    const Outcome bad = run("check three.vtk");
    EXPECT_EQ(bad.code, 1);
    EXPECT_NE(bad.text.find("overused faces"), std::string::npos) << bad.text;
}

// Two boxes with points of their own, the second against the lower half of the first one's side.
TEST_F(CommandLine, CheckNamesHangingPointsByIdAndPlace) {
    write("halves.vtk", "# vtk DataFile Version 3.0\nhalves\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 16 double\n"
                        "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n"
                        "1 0 0 2 0 0 2 1 0 1 1 0 1 0 0.5 2 0 0.5 2 1 0.5 1 1 0.5\n"
                        "CELLS 2 18\n8 0 1 2 3 4 5 6 7\n8 8 9 10 11 12 13 14 15\nCELL_TYPES 2\n12\n12\n");
    const Outcome outcome = run("check halves.vtk");
    EXPECT_EQ(outcome.code, 1);
    for (const char* words : {"hanging points         2:", "point 12 at (1, 0, 0.5)", "point 15 at (1, 1, 0.5)"}) {
        EXPECT_NE(outcome.text.find(words), std::string::npos) << "no \"" << words << "\" in:\n" << outcome.text;
    }
    const auto hanging = nlohmann::json::parse(run("check halves.vtk --json").text).at("hanging_points");
    EXPECT_EQ(hanging, nlohmann::json::parse(R"({"count": 2, "of": "points", "first": [12, 15], "at": [[1,0,0.5],[1,1,0.5]]})"));
}

// Cells are told by their number in the file, not by that of a tetrahedron of theirs.
TEST_F(CommandLine, CheckNamesCellsOfTheFile) {
    write("twice.vtk", "# vtk DataFile Version 3.0\ntwice\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 16 double\n"
                       "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n"
                       "5 0 0 6 0 0 6 1 0 5 1 0 5 0 1 6 0 1 6 1 1 5 1 1\n"
                       "CELLS 3 27\n8 0 1 2 3 4 5 6 7\n8 8 9 10 11 12 13 14 15\n8 8 9 10 11 12 13 14 15\nCELL_TYPES 3\n12\n12\n12\n");
    const auto json = nlohmann::json::parse(run("check twice.vtk --json").text);
    EXPECT_EQ(json.at("faithful"), false);
    ASSERT_FALSE(json.at("overlapping_cells").at("first").empty());
    EXPECT_EQ(json.at("overlapping_cells").at("first").at(0), 1);
    EXPECT_GT(json.at("overlapping_cells").at("at").at(0).at(0), 5.0);
}

TEST_F(CommandLine, InfoSuggestsAFieldThatVaries) {
    write("marked.vtk", "# vtk DataFile Version 3.0\nmarked\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
                        "0 0 0 1 0 0 0 1 0 0 0 1 9 9 9\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 5\n"
                        "SCALARS id double 1\nLOOKUP_TABLE default\n1 2 3 4 5\nSCALARS T double 1\nLOOKUP_TABLE default\n"
                        "300 300 300 300 300\nSCALARS p double 1\nLOOKUP_TABLE default\n0.5 1 1.5 2 2\n");
    const std::string text = run("info marked.vtk").text;
    for (const char* words : {"5 (1 of them in no volume cell)", "300 .. 300, constant", "volume      0.166667", "--field p\n"}) {
        EXPECT_NE(text.find(words), std::string::npos) << "no \"" << words << "\" in:\n" << text;
    }
}

// A name with blanks must survive the shell; what `info` suggests is what `render` draws on its own.
TEST_F(CommandLine, RenderDrawsWhatInfoSuggests) {
    const std::string ids = "SCALARS id double 1\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\nSCALARS p double 1\n"
                            "LOOKUP_TABLE default\n0.5 1 2 3 4 5 6 7\n";
    write("my cube.vtk", replaced(cube(), "SCALARS p double 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n", ids));
    const std::string text = run("info 'my cube.vtk'").text;
    EXPECT_NE(text.find("render 'my cube.vtk' -o picture.png --field p\n"), std::string::npos) << text;
    ASSERT_EQ(run("render 'my cube.vtk' -o a.png --size 20x20").code, 0);
    ASSERT_EQ(run("render 'my cube.vtk' -o b.png --size 20x20 --field p").code, 0);
    EXPECT_EQ(content("a.png"), content("b.png"));
}

TEST_F(CommandLine, AMeshWithoutFieldsIsDrawnByACoordinate) {
    const std::string whole = cube();
    write("bare.vtk", whole.substr(0, whole.find("POINT_DATA")));
    const std::string text = run("info bare.vtk").text;
    EXPECT_NE(text.find("render bare.vtk -o picture.png --field Points:z"), std::string::npos) << text;
    expect_refused("render bare.vtk -o a.png", {"bare.vtk", "at least one field", "--field Points:z"});
    EXPECT_EQ(run("render bare.vtk -o a.png --size 20x20 --field Points:z").code, 0);
    EXPECT_TRUE(fs::exists(path("a.png")));
}

TEST_F(CommandLine, CellFieldsConstantOrAveraged) {
    EXPECT_EQ(run("render cube.vtk -o a.exr --size 20x20 --field rank --cell-values averaged").code, 0);
    EXPECT_EQ(run("render cube.vtk -o b.exr --size 20x20 --field U:x").code, 0);
    EXPECT_EQ(run("render cube.vtk -o b.exr --size 20x20 --cell-values often").code, 2);
}

TEST_F(CommandLine, RawVolumesAndHowToReadThem) {
    write("voxels.raw", "??" + std::string(12, '\x07') + std::string(12, '\x08'));
    const Outcome info = run("info voxels.raw --dims 2 3 4 --type int8 --spacing 1 1 0.5 --header 2");
    EXPECT_EQ(info.code, 0) << info.text;
    for (const char* words : {"raw volume", "24 (2x3x4)", "z 0 .. 1.5", "7 .. 8",
                              "render voxels.raw --dims 2 3 4 --type int8 --spacing 1 1 0.5 --origin 0 0 0 --header 2 -o"}) {
        EXPECT_NE(info.text.find(words), std::string::npos) << "no \"" << words << "\" in:\n" << info.text;
    }
    expect_refused("info voxels.raw --dims 2 3 4 --type int8", {"voxels.raw", "24 bytes", "26 bytes"});
    expect_refused("info voxels.raw", {"--dims"});
    for (const char* usage : {"info voxels.raw --dims 2 3 4", "info voxels.raw --type int8", "info voxels.raw --dims 2 3 --type int8",
                              "info voxels.raw --dims 2 3 4 --type int9", "info voxels.raw --dims 2 3 4 --type int8 --spacing 1 nan 1",
                              "info voxels.raw --header 2", "info cube.vtk --subdivide 2"}) {
        EXPECT_EQ(run(usage).code, 2) << usage;
    }
}

// One corner of the only cell: four of its five tetrahedra have it. The fifth is 0 throughout, which is all there is to see
// without them, and transparent once there are larger values.
TEST_F(CommandLine, ValuesThatAreNotFiniteBecomeANumberOnDemand) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::string bytes(8 * sizeof(float), '\0');
    std::memcpy(bytes.data() + 4, &nan, sizeof nan);
    write("nan.raw", bytes);
    const std::string command = "render nan.raw --dims 2 2 2 --type float32 -o nan.exr --size 20x20 --as tets";
    const Outcome left_out = run(command);
    EXPECT_EQ(left_out.code, 0) << left_out.text;
    EXPECT_NE(left_out.text.find("1 of 8 values are not finite"), std::string::npos) << left_out.text;
    const Outcome drawn = run(command + " --nan 1");
    EXPECT_EQ(drawn.code, 0) << drawn.text;
    EXPECT_EQ(drawn.text.find("not finite"), std::string::npos) << drawn.text;
    EXPECT_NE(left_out.text.find("1 of 5 cells"), std::string::npos) << left_out.text;
    EXPECT_NE(drawn.text.find("4 of 5 cells"), std::string::npos) << drawn.text;
    EXPECT_EQ(run(command + " --nan inf").code, 2);
}

TEST_F(CommandLine, HelpVersionAndUsage) {
    EXPECT_EQ(run("--help").code, 0);
    EXPECT_NE(run("--help").text.find("Examples:"), std::string::npos);
    EXPECT_EQ(run("render --help").code, 0);
    EXPECT_EQ(run("--version").code, 0);
    EXPECT_EQ(run("").code, 2);
    EXPECT_EQ(run("render").code, 2);
    EXPECT_EQ(run("render cube.vtk -o a.png --no-such-flag").code, 2);
    EXPECT_EQ(run("render cube.vtk -o a.png --frames zero").code, 2);
    EXPECT_EQ(run("paint cube.vtk").code, 2);
}

TEST_F(CommandLine, RefusesBadFiles) {
    expect_refused("render missing.vtu -o a.png", {"missing.vtu"});
    write("empty.vtu", "");
    expect_refused("render empty.vtu -o a.png", {"empty.vtu", "empty"});
    write("cut.vtu", "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n<UnstructuredGrid>\n<Piece NumberOf");
    expect_refused("render cut.vtu -o a.png", {"cut.vtu"});
    expect_refused("render . -o a.png", {"folder"});
    expect_refused("info missing.vtu", {"missing.vtu"});
    write("surface.vtk", replaced(replaced(cube(), "CELLS 1 9\n8 0 1 2 3 4 5 6 7", "CELLS 1 4\n3 0 1 2"), "CELL_TYPES 1\n12", "CELL_TYPES 1\n5"));
    expect_refused("render surface.vtk -o a.png", {"surface.vtk", "volume"});
    std::string vtu = "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">"
                      "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 nan</DataArray></Points>"
                      "<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>"
                      "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray>"
                      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
    write("nan.vtu", vtu);
    expect_refused("render nan.vtu -o a.png", {"nan.vtu"});
    write("outside.vtk", replaced(cube(), "8 0 1 2 3 4 5 6 7", "8 0 1 2 3 4 5 6 99"));
    expect_refused("render outside.vtk -o a.png", {"outside.vtk", "99"});
}

TEST_F(CommandLine, RefusesBadChoices) {
    expect_refused("render cube.vtk -o a.png --field q", {"\"q\"", "\"p\"", "\"U\"", "\"rank\""});
    expect_refused("render cube.vtk -o a.png --size 0x0", {"--size", "0x0"});
    expect_refused("render cube.vtk -o a.png --size 20000x10", {"--size", "16384"});
    expect_refused("render cube.vtk -o a.png --size big", {"--size", "big"});
    expect_refused("render cube.vtk -o no/such/folder/a.png", {"no/such/folder"});
    expect_refused("render cube.vtk -o cube.vtk/a.png", {"cube.vtk"});
    expect_refused("render cube.vtk -o a.jpg", {".png"});
    expect_refused("render cube.vtk -o a.png --stats no/such/s.json", {"no/such"});
    expect_refused("render cube.vtk -o a.png --up 0,0,0", {"up"});
    expect_refused("render demo:cube -o a.png", {"demo:sphere"});
}

TEST_F(CommandLine, RefusesBadTransferFunctionsAndCameras) {
    const auto transfer = [&](const std::string& extinction) {
        write("tf.json", R"({"model": "density", "color": [[0,1,0,0]], "extinction": )" + extinction + "}");
    };
    transfer("[[0,1],[2,1],[1,0]]");
    expect_refused("render cube.vtk -o a.png --transfer tf.json", {"tf.json"});
    transfer("[[0,1],[null,1]]");
    expect_refused("render cube.vtk -o a.png --transfer tf.json", {"tf.json"});
    transfer("[[0,1],[NaN,1]]");
    expect_refused("render cube.vtk -o a.png --transfer tf.json", {"tf.json"});
    expect_refused("render cube.vtk -o a.png --transfer missing.json", {"missing.json"});
    expect_refused("render cube.vtk -o a.png --camera missing.json", {"missing.json"});
    expect_refused("render cube.vtk -o a.png --camera .", {"expected"});
    write("cam.json", R"({"projection": "parallel", "eye": [0,0,0], "center": [0,0,0], "up": [0,0,1], "height": 2})");
    expect_refused("render cube.vtk -o a.png --camera cam.json", {"cam.json", "eye"});
}

TEST_F(CommandLine, ColorsAreChosenByName) {
    const auto picture = [&](const std::string& options) {
        const Outcome outcome = run("render cube.vtk -o a.png --size 20x20 " + options);
        EXPECT_EQ(outcome.code, 0) << outcome.text;
        return content("a.png");
    };
    const std::string plain = picture("");
    EXPECT_EQ(picture("--colors viridis --opacity-scale 1 --axis linear"), plain);
    EXPECT_NE(picture("--colors turbo"), plain);
    EXPECT_NE(picture("--range 0,2"), plain);
    EXPECT_NE(picture("--opacity-scale 3"), plain);
    EXPECT_NE(picture("--axis log --range 0.5,7"), picture("--range 0.5,7"));
    write("tf.json", R"({"preset": "gray", "range": [0, 7], "extinction": [[0, 0], [7, 3]]})");
    EXPECT_NE(picture("--transfer tf.json --opacity-scale 0.5"), picture("--transfer tf.json"));
    EXPECT_NE(run("render cube.vtk -o a.png --size 20x20 --opacity-scale 0").text.find("blank"), std::string::npos);

    expect_refused("render cube.vtk -o b.png --colors jet", {"--colors", "\"jet\"", "viridis"});
    expect_refused("render cube.vtk -o b.png --range 2,1", {"--range", "2,1"});
    expect_refused("render cube.vtk -o b.png --range nan,1", {"--range"});
    expect_refused("render cube.vtk -o b.png --range 0,1e200", {"--range", "1e+200", "1e150"});
    expect_refused("render cube.vtk -o b.png --axis log", {"--axis log", "\"p\"", "--range"});
    expect_refused("render cube.vtk -o b.png --transfer tf.json#Jet", {"tf.json", "Jet"});
    EXPECT_EQ(run("render cube.vtk -o b.png --colors turbo --transfer tf.json").code, 2);
    EXPECT_EQ(run("render cube.vtk -o b.png --axis cubic").code, 2);
    EXPECT_EQ(run("render cube.vtk -o b.png --opacity-scale -1").code, 2);
    EXPECT_EQ(run("render cube.vtk -o b.png --range 1").code, 2);
}

TEST_F(CommandLine, ABlankPictureIsNotSilent) {
    write("far.json", R"({"projection": "parallel", "eye": [900,0,0], "center": [900,9,0], "up": [0,0,1], "height": 1})");
    const Outcome outcome = run("render cube.vtk -o a.png --size 20x20 --camera far.json");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.text.find("blank"), std::string::npos);
}

TEST_F(CommandLine, PicturesThatCannotBeWrittenLeaveTheOldOne) {
    write("a.png", "old");
    expect_refused("render missing.vtu -o a.png", {"missing.vtu"});
    EXPECT_EQ(content("a.png"), "old");
}

}  // namespace
