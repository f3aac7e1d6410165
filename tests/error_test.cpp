// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/error.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace cellproj {
namespace error_test {

TEST(Error, MessageJoinsItsParts) {
    const Error error({ErrorKind::data, "a.vtu, point 3", "finite coordinates", "(nan, 0, 0)", "remove it"});
    EXPECT_STREQ(error.what(), "a.vtu, point 3: expected finite coordinates, found (nan, 0, 0); remove it");
    EXPECT_EQ(error.kind(), ErrorKind::data);
}

TEST(Error, MessageLeavesOutWhatIsEmpty) {
    EXPECT_STREQ(Error({ErrorKind::file, "a.vtu", "", "an empty file", ""}).what(), "a.vtu: an empty file");
}

TEST(NearestName, FindsTheClosestSpelling) {
    const std::vector<std::string> known{"color", "extinction", "opacity"};
    EXPECT_EQ(nearest_name("colour", known), "color");
    EXPECT_EQ(nearest_name("opasity", known), "opacity");
    EXPECT_EQ(nearest_name("extinction", known), "extinction");
    EXPECT_EQ(nearest_name("anything", {}), "");
}

TEST(RequireKnownKeys, NamesTheUnknownKeyAndTheNearest) {
    const std::vector<std::string> known{"eye", "center", "up"};
    EXPECT_NO_THROW(require_known_keys("cam.json", std::vector<std::string>{"up", "eye"}, known));
    try {
        require_known_keys("cam.json", std::vector<std::string>{"eye", "centre"}, known);
        FAIL() << "no error";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("cam.json"), std::string::npos);
        EXPECT_NE(message.find("\"centre\""), std::string::npos);
        EXPECT_NE(message.find("did you mean \"center\""), std::string::npos);
    }
}

}  // namespace
}  // namespace cellproj
