// SPDX-License-Identifier: BSD-3-Clause
//
// cellproj_frames on a tiny scene: what it writes can be read, and what fails is told in its row.
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/folder_test.hpp"

namespace cellproj {
namespace frames_test {

using Row = std::map<std::string, std::string>;  // by column

std::vector<std::string> split(const std::string& line) {  // at commas outside of quotes
    std::vector<std::string> values(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        else if (c == ',' && !quoted) values.emplace_back();
        else values.back() += c;
    }
    return values;
}

class Frames : public testing_support::FolderTest {
protected:
    // cellproj_frames with these arguments.
    testing_support::Outcome run(const std::string& arguments) const {
        return testing_support::run_command(folder_, "'" CELLPROJ_FRAMES "' " + arguments);
    }
    std::vector<Row> rows(const std::string& csv) const {
        std::istringstream lines(content(csv));
        std::string line;
        std::getline(lines, line);
        const auto names = split(line);
        std::vector<Row> rows;
        while (std::getline(lines, line)) {
            const auto values = split(line);
            EXPECT_EQ(values.size(), names.size()) << line;
            Row& row = rows.emplace_back();
            for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) row[names[i]] = values[i];
        }
        return rows;
    }
};

TEST_F(Frames, WriteATableThatCanBeRead) {
    const auto outcome = run("--scenes grid:5 --transfers ramp --sizes 48 --frames 3 --judge 300 --projections perspective,parallel "
                             "--contenders cpu,gl --csv frames.csv --markdown frames.md");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    const auto table = rows("frames.csv");
    ASSERT_EQ(table.size(), 4U);
    for (const Row& row : table) {
        SCOPED_TRACE(row.at("projection") + " " + row.at("contender"));
        const auto number = [&](const char* column) { return std::stod(row.at(column)); };
        EXPECT_EQ(row.at("tets"), "384");  // 4³ boxes of 6
        EXPECT_EQ(row.at("failure"), "");
        EXPECT_GT(number("set_up_ms"), 0);
        EXPECT_GT(number("first_ms"), number("set_up_ms"));
        EXPECT_GT(number("frame_ms"), 0);
        EXPECT_GE(number("user_ms"), 0);  // the clock of CPU time may not have ticked
        EXPECT_GT(number("bytes_per_tet"), 0);
        // The picture that is judged is the one that was drawn: the bar of the methods' own tests.
        EXPECT_LT(number("rms"), 5e-4);
        EXPECT_GE(number("max"), number("rms"));
    }
    EXPECT_GT(std::stod(table[0].at("pixels_per_tet")), 1);
    EXPECT_EQ(table[0].at("contender"), "cpu");
    EXPECT_NE(content("frames.md").find("| grid:5 | 384 | ramp | parallel | 48 | gl |"), std::string::npos) << content("frames.md");
}

TEST_F(Frames, TellWhatFailsInItsRow) {
    // The CPU backend has no light at vertices.
    const auto outcome = run("--scenes grid:3 --transfers ramp --sizes 16 --frames 1 --judge 50 --contenders cpu,gl --method shirley-tuchman --csv f.csv");
    EXPECT_EQ(outcome.code, 1);
    const auto table = rows("f.csv");
    ASSERT_EQ(table.size(), 2U) << outcome.text;
    EXPECT_NE(table[0].at("failure"), "");
    EXPECT_EQ(table[0].at("frame_ms"), "");
    EXPECT_EQ(table[1].at("failure"), "");
    EXPECT_GT(std::stod(table[1].at("frame_ms")), 0);
}

TEST_F(Frames, RefuseWhatTheyDoNotKnow) {
    EXPECT_EQ(run("--contenders abacus").code, 2);
    const auto refused = run("--scenes grid:1");
    EXPECT_EQ(refused.code, 1);
    EXPECT_NE(refused.text.find("from 2 to 500"), std::string::npos) << refused.text;
}

}  // namespace
}  // namespace cellproj
