// SPDX-License-Identifier: BSD-3-Clause
//
// Time and error as a user meets them: `cellproj trade`, and `render --max-error`.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/folder_test.hpp"

namespace trade_command_test {

namespace fs = std::filesystem;
using cellproj::testing_support::FolderTest;
using cellproj::testing_support::Outcome;
using cellproj::testing_support::run_program;

class TradeCommand : public FolderTest {
protected:
    // 27 voxels of a field that is not linear in any cell.
    void SetUp() override {
        FolderTest::SetUp();
        std::string voxels;
        for (int i = 0; i < 27; ++i) voxels += static_cast<char>(i * i % 23);
        write("v.raw", voxels);
    }

    // As tetrahedra; grid_command_test draws the grid as it is.
    Outcome run(const std::string& command, const std::string& options) const {
        return run_program(folder_, command + " v.raw --dims 3 3 3 --type uint8 --size 40x40 --as tets " + options);
    }

    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

    // The exit code, the words in the message, and no file more than before.
    void expect_refused(int code, const std::string& command, const std::string& options,
                        std::initializer_list<const char*> words) const {
        const auto before = files();
        const Outcome outcome = run(command, options);
        EXPECT_EQ(outcome.code, code) << options << "\n" << outcome.text;
        for (const char* word : words) EXPECT_NE(outcome.text.find(word), std::string::npos) << word << " in: " << outcome.text;
        EXPECT_EQ(files(), before) << options;
    }
};

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
}

TEST_F(TradeCommand, WritesTheSameTableFourTimes) {
    const Outcome outcome =
        run("trade", "--method average --method integral --method preint3d:8 --target rgba32f --target rgba8 --rounds 2 "
                     "-o t.html --csv t.csv --json t.json");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_EQ(files(), (std::vector<std::string>{"t.csv", "t.html", "t.json", "v.raw"}));

    const auto json = nlohmann::json::parse(content("t.json"));
    const auto& rows = json.at("methods");
    ASSERT_EQ(rows.size(), 6U);
    EXPECT_EQ(json.at("rounds"), 2);
    EXPECT_EQ(json.at("whole_picture"), true);
    EXPECT_GT(json.at("judged_pixels"), 100);
    std::istringstream csv(content("t.csv"));
    std::string line;
    std::getline(csv, line);
    EXPECT_EQ(line, "method,target,backend,frame_ms,set_up_ms,table_bytes,rms,percentile_99,maximum,opacity_rms,opacity_maximum,on_front,iso_method,drawn_as,sampling");
    double last = 0;
    std::size_t front = 0;
    for (const auto& row : rows) {
        const std::string method = row.at("method"), target = row.at("target");
        std::getline(csv, line);
        const std::string backend = row.at("backend");
        EXPECT_EQ(backend, target == "rgba8" ? "gl_osmesa" : "cpu");  // auto: cpu where it draws the method
        EXPECT_EQ(line.rfind(method + "," + target + "," + backend + ",", 0), 0U) << line;
        EXPECT_GE(row.at("ms").at("frame"), last);  // sorted by time
        last = row.at("ms").at("frame");
        front += row.at("on_front").get<bool>() ? 1 : 0;
        const std::string label = method + (target == "rgba8" ? ", rgba8" : "");
        EXPECT_NE(outcome.text.find(label), std::string::npos);
        EXPECT_NE(content("t.html").find("<td>" + label + "<td>"), std::string::npos) << label;
    }
    EXPECT_FALSE(std::getline(csv, line)) << line;
    EXPECT_GE(front, 1U);
    EXPECT_NE(outcome.text.find("pixels that see the mesh judged, medians of 2 frames"), std::string::npos) << outcome.text;
}

TEST_F(TradeCommand, MeasuresIsosurfaces) {
    const Outcome outcome = run("trade", "--rounds 1 --iso 7:white:0.5 --volume --method integral --iso-method exact --iso-method table:65 --iso-method combined:65 --json t.json");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    const auto json = nlohmann::json::parse(content("t.json"));
    std::vector<std::string> names;
    for (const auto& row : json.at("methods")) {
        names.push_back(row.at("iso_method"));
        const double worst = row.at("error").at("color").at("maximum");
        EXPECT_TRUE(names.back() == "exact" ? worst < 1e-3 : worst > 1e-3) << names.back() << " " << worst;
    }
    std::sort(names.begin(), names.end());
    EXPECT_EQ(names, (std::vector<std::string>{"combined:65", "exact", "table:65"}));
    expect_refused(2, "trade", "--iso-method table", {"--iso"});
    expect_refused(1, "render", "--iso 7 --iso-method tables -o p.png", {"--iso-method", "tables"});
    expect_refused(1, "render", "--iso 7 --iso-method table --backend cpu -o p.png", {"--iso-method", "gl"});
}

// Of what is clipped, sliced and hidden the judge knows the same. Light at vertices, which knows no place on a ray, is not among the usual ways then.
TEST_F(TradeCommand, MeasuresWhatIsCut) {
    for (const char* cuts : {"--clip 1,1,1.2:0.2,0.1,1 --caps", "--slice 1,1,0.7:0.1,0.2,1 --volume", "--surface demo:sphere"}) {
        const Outcome outcome = run("trade", std::string("--rounds 1 --json t.json --method exact:1e-5 ") + cuts);
        ASSERT_EQ(outcome.code, 0) << outcome.text;
        const auto json = nlohmann::json::parse(content("t.json"));
        ASSERT_EQ(json.at("methods").size(), 1U);
        EXPECT_LT(json.at("methods").at(0).at("error").at("color").at("maximum"), 1e-4) << cuts;
    }
    const Outcome usual = run("trade", "--rounds 1 --sample 50 --target rgba32f --clip 1,1,1.2:0.2,0.1,1 --json t.json");
    ASSERT_EQ(usual.code, 0) << usual.text;
    for (const char* method : {"shirley-tuchman", ":vertices"}) EXPECT_EQ(usual.text.find(method), std::string::npos) << usual.text;
    std::filesystem::remove(folder_ / "t.json");
    expect_refused(1, "trade", "--clip 1,1,1:0,0,1 --method shirley-tuchman", {"--method", "1 clipping plane", "shirley-tuchman"});
}

TEST_F(TradeCommand, ThePageHoldsAllItShows) {
    ASSERT_EQ(run("trade", "--method average --method integral --rounds 1 -o t.html").code, 0);
    const std::string page = content("t.html");
    EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0U);
    EXPECT_NE(page.find("</html>"), std::string::npos);
    EXPECT_EQ(count(page, "data:image/png;base64,"), 6U);  // the legend, the truth, and two for each method
    EXPECT_EQ(count(page, "src="), 6U);
    EXPECT_EQ(count(page, "://"), 1U);  // the name of SVG's language: nothing is fetched
    for (const char* word : {"[ms]", "RMS error of the colours", "<polyline", "integral"})
        EXPECT_NE(page.find(word), std::string::npos) << word;
}

TEST_F(TradeCommand, DrawsByTheBackendThatIsAskedFor) {
    ASSERT_EQ(run("trade", "--backend gl --method average --method integral --rounds 1 --json t.json").code, 0);
    const auto by_gl = nlohmann::json::parse(content("t.json"));
    for (const auto& row : by_gl.at("methods")) EXPECT_EQ(row.at("backend"), "gl_osmesa");
    const Outcome all = run("trade", "--backend cpu --rounds 1 --json t.json");  // of all methods, those that it draws
    ASSERT_EQ(all.code, 0) << all.text;
    const auto json = nlohmann::json::parse(content("t.json"));
    EXPECT_GT(json.at("methods").size(), 10U);
    for (const auto& row : json.at("methods")) EXPECT_EQ(row.at("backend"), "cpu");
    expect_refused(1, "trade", "--backend cpu --method shirley-tuchman --json u.json", {"--method", "--backend gl"});
    expect_refused(2, "trade", "--backend vulkan", {"--backend"});
}

TEST_F(TradeCommand, JudgesAsManyPixelsAsAskedFor) {
    ASSERT_EQ(run("trade", "--method average --rounds 1 --sample 50 --json t.json").code, 0);
    const auto json = nlohmann::json::parse(content("t.json"));
    EXPECT_EQ(json.at("judged_pixels"), 50);
    EXPECT_EQ(json.at("whole_picture"), false);
}

TEST_F(TradeCommand, RefusesBadArgumentsAndLeavesNothing) {
    expect_refused(1, "trade", "--method averge -o t.html", {"--method", "\"average\""});
    expect_refused(1, "trade", "--target rgba9 -o t.html", {"--target", "rgba8"});
    expect_refused(1, "trade", "-o t.html --csv t.html", {"--csv", "t.html twice"});
    expect_refused(1, "trade", "-o no/such/t.html", {"no/such"});
    expect_refused(1, "trade", "--field q -o t.html", {"\"q\""});
    expect_refused(1, "trade", "--transfer none.json --json t.json", {"none.json"});
    expect_refused(1, "trade", "--backend cpu --opacity-field Points:x -o t.html", {"--opacity-field", "--backend gl"});
    expect_refused(1, "trade", "--method preint3d:16 --opacity-field Points:x -o t.html", {"--method", "preint3d:16", "integral"});
    expect_refused(2, "trade", "--rounds 0 -o t.html", {"--rounds"});
    expect_refused(2, "trade", "--sample 0 -o t.html", {"--sample"});
    const std::string camera = R"({"projection": "parallel", "eye": [9,2,1], "center": [1,1,1], "up": [0,0,1], "height": 4})";
    write("two.json", "[" + camera + "," + camera + "]");
    expect_refused(1, "trade", "--camera two.json -o t.html", {"--camera", "one camera", "2"});
    write("old.csv", "old");
    expect_refused(1, "trade", "--camera two.json --csv old.csv", {"--camera"});
    EXPECT_EQ(content("old.csv"), "old");
}

TEST_F(TradeCommand, MaxErrorPrintsWhatItMeasuredAndTellsTheStatistics) {
    const Outcome outcome = run("render", "-o a.exr --max-error 0.01 --orbit 90 --frames 2 --stats s.json");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    for (const char* words : {"--max-error 0.01", "of the first view", "integral", "exact:0.0001", "  the fastest within it"})
        EXPECT_NE(outcome.text.find(words), std::string::npos) << "no " << words << " in:\n" << outcome.text;
    const auto pictures = nlohmann::json::parse(content("s.json")).at("pictures");
    EXPECT_LE(pictures.at(0).at("error"), 0.01);
    EXPECT_TRUE(pictures.at(1).at("error").is_null());  // not measured there
    const std::string method = pictures.at(0).at("method");
    EXPECT_EQ(pictures.at(1).at("method"), method);
    std::istringstream lines(outcome.text);
    std::string line;
    while (std::getline(lines, line) && line.find("the fastest within it") == std::string::npos) {}
    EXPECT_EQ(line.rfind("  " + method + " ", 0), 0U) << line;
}

TEST_F(TradeCommand, MaxErrorSaysWhenNoMethodKeepsIt) {
    const Outcome outcome = run("render", "-o a.png --target rgba8 --max-error 1e-5 --stats s.json");
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    for (const char* words : {"warning: no method was within --max-error 1e-05", "exact:1e-07", "taken, though above it"})
        EXPECT_NE(outcome.text.find(words), std::string::npos) << "no " << words << " in:\n" << outcome.text;
    const auto picture = nlohmann::json::parse(content("s.json")).at("pictures").at(0);
    EXPECT_EQ(picture.at("method"), "exact:1e-07");
    EXPECT_GT(picture.at("error"), 1e-5);
}

TEST_F(TradeCommand, MaxErrorIsAPositiveNumberAndNoMethod) {
    for (const char* bad : {"0", "-1", "nan", "2", "small"})
        expect_refused(2, "render", std::string("-o a.png --max-error ") + bad, {"--max-error", bad, "above 0"});
    expect_refused(2, "render", "-o a.png --max-error 0.1 --method integral", {"--max-error", "--method"});
}

}  // namespace
