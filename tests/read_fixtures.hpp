// SPDX-License-Identifier: BSD-3-Clause
//
// What the tests of `read` share: files in a folder of their own, and errors looked at from all sides.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "mesh/error.hpp"
#include "mesh/read.hpp"

namespace cellproj {

namespace fs = std::filesystem;

inline fs::path scratch_folder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const fs::path folder = fs::path(testing::TempDir()) / "cellproj_read_test" /
                            (std::string(test->test_suite_name()) + "." + test->name());
    fs::create_directories(folder);
    return folder;
}

inline fs::path write(const std::string& name, const std::string& bytes) {
    const fs::path file = scratch_folder() / name;
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
}

// What `read` throws; a test fails when it does not, or when the message does not name the file, or is told to the
// terminal.
inline Error error_of(const fs::path& file, const ReadOptions& options = {}) {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    std::optional<Error> caught;
    try {
        read(file, options);
    } catch (const Error& error) {
        caught = error;
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    if (!caught) throw std::logic_error("reading " + file.string() + " threw nothing");
    EXPECT_FALSE(caught->advice().empty());
    return *caught;
}

inline void expect_error(const fs::path& file, ErrorKind kind, const std::string& words,
                         const ReadOptions& options = {}) {
    const Error error = error_of(file, options);
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    EXPECT_NE(error.place().find(file.filename().string()), std::string::npos) << error.what();
}

class ReadSharedData : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(data)) GTEST_SKIP() << "no folder " << data;
    }
    const fs::path data = CELLPROJ_SHARED_DATA;
};

}  // namespace cellproj
