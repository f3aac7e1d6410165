// SPDX-License-Identifier: BSD-3-Clause
//
// What the tests of `read` share: files in a folder of their own, and errors looked at from all sides.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "tests/support/scratch_folder.hpp"

namespace cellproj {

namespace fs = std::filesystem;

using testing_support::scratch_folder;

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

inline const Field& field(const std::vector<Field>& fields, const std::string& name) {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
    if (found == fields.end()) throw std::logic_error("no field " + name);
    return *found;
}

// `file` cut at ten places and read through `entry` gives an Error or the whole number of points and cells; nothing is
// printed.
inline void expect_cuts_told(const fs::path& entry, const fs::path& file) {
    SCOPED_TRACE(file);
    const Dataset whole = read(entry);
    const std::string bytes = [&] {
        std::ifstream stream(file, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    }();
    fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    testing::internal::CaptureStderr();
    for (std::size_t cut = 0; cut < 10; ++cut) {
        const std::size_t size = bytes.size() * cut / 10;
        std::ofstream(file, std::ios::binary) << bytes.substr(0, size);
        try {
            const Dataset dataset = read(entry);
            EXPECT_EQ(dataset.points.size(), whole.points.size()) << size;
            EXPECT_EQ(dataset.cell_count(), whole.cell_count()) << size;
        } catch (const Error& error) {
            EXPECT_NE(error.place().find(entry.parent_path().string()), std::string::npos) << error.what();
        }
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    std::ofstream(file, std::ios::binary) << bytes;
}

class ReadSharedData : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(data)) GTEST_SKIP() << "no folder " << data;
    }
    const fs::path data = CELLPROJ_SHARED_DATA;
};

}  // namespace cellproj
