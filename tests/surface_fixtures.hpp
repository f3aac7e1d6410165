// SPDX-License-Identifier: BSD-3-Clause
//
// Surface files written by a test, and refused ones.
#pragma once

#include <string>

#include "mesh/surface.hpp"
#include "tests/mesher_fixtures.hpp"
#include "tests/support/folder_test.hpp"

namespace cellproj {

class SurfaceFile : public testing_support::FolderTest {
protected:
    // The Error names the file; its text holds `words`.
    void expect_refused(const std::string& name, const std::string& bytes, const std::string& words) const {
        const std::filesystem::path file = write(name, bytes);
        const Error error = mesher_fixtures::error_of([&] { read_surface(file); });
        EXPECT_NE(error.place().find(file.string()), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
};

}  // namespace cellproj
