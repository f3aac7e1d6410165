// SPDX-License-Identifier: BSD-3-Clause
//
// A small volume of bare voxels, rendered by the program as a user would: what tests of its options for surfaces and cuts share.
#pragma once

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "tests/support/folder_test.hpp"

namespace cellproj::testing_support {

using Pixel = std::array<int, 3>;

class VoxelSceneTest : public FolderTest {
protected:
    // Voxels whose scalar rises from 0 to 20 towards the viewer of from_below().
    void SetUp() override {
        FolderTest::SetUp();
        std::string voxels;
        for (int i = 0; i < 27; ++i) voxels += static_cast<char>(10 * (2 - i / 9));
        write("v.raw", voxels);
    }

    static constexpr const char* scene = "v.raw --dims 3 3 3 --type uint8 --size 21x21 --projection parallel --from 0,0,-1 --up 0,1,0 ";

    Outcome run(const std::string& options) const { return run_program(folder_, "render " + (scene + ("-o p.png " + options))); }

    // The middle pixel.
    Pixel seen(const std::string& options) const {
        const Outcome outcome = run(options);
        EXPECT_EQ(outcome.code, 0) << outcome.text;
        return middle_of("p.png");
    }

    Pixel middle_of(const std::string& name) const {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        EXPECT_TRUE(png_image_begin_read_from_file(&image, (folder_ / name).c_str()));
        image.format = PNG_FORMAT_RGB;
        std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
        EXPECT_TRUE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr));
        const std::size_t i = 3 * (std::size_t{image.height} / 2 * image.width + image.width / 2);
        return {bytes[i], bytes[i + 1], bytes[i + 2]};
    }

    void expect_refused(const std::string& options, std::initializer_list<const char*> words) const {
        const Outcome outcome = run(options);
        EXPECT_EQ(outcome.code, 1) << options << "\n" << outcome.text;
        for (const char* word : words) EXPECT_NE(outcome.text.find(word), std::string::npos) << "no \"" << word << "\" in: " << outcome.text;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "p.png")) << options;
    }
};

}  // namespace cellproj::testing_support
