// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/isolated_read.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "mesh/io/byte_stream.hpp"

namespace cellproj {
namespace isolated_read_test {

// As after a fork at a bad moment: the first child waits for ever, the second one does not.
TEST(IsolatedRead, AChildThatStandsStillIsTriedOnceMore) {
    const auto marker = std::filesystem::temp_directory_path() / ("cellproj_stands_still_" + std::to_string(getpid()));
    int number = 0;
    run_isolated(
        "file.vtu", 0, {},
        [&](ByteWriter& writer) {
            if (!std::filesystem::exists(marker)) {
                std::ofstream(marker) << "tried";
                for (;;) pause();
            }
            writer.value(7);
        },
        [&](ByteReader& reader) { number = reader.value<int>("number"); });
    EXPECT_EQ(number, 7);
    EXPECT_TRUE(std::filesystem::remove(marker));
}

}  // namespace
}  // namespace cellproj
