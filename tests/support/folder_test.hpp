// SPDX-License-Identifier: BSD-3-Clause
//
// Tests that work in a folder of their own, and run the program there.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/scratch_folder.hpp"

namespace cellproj::testing_support {

inline std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// The folder is empty at the start of each case and gone behind it.
class FolderTest : public testing::Test {
protected:
    void SetUp() override {
        folder_ = scratch_folder();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    std::string content(const std::string& name) const { return bytes_of(folder_ / name); }

    std::filesystem::path folder_;
};

struct Outcome {
    int code = -1;
    std::string text;  // standard output and error together
};

// Runs a line of the shell in `folder`.
inline Outcome run_command(const std::filesystem::path& folder, const std::string& command) {
    Outcome outcome;
    FILE* pipe = popen(("cd '" + folder.string() + "' && " + command + " 2>&1").c_str(), "r");
    std::array<char, 4096> buffer{};
    for (std::size_t n = 0; (n = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
        outcome.text.append(buffer.data(), n);
    const int status = pclose(pipe);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

// Runs cellproj with these arguments in `folder`, behind settings of the environment: "NAME=value".
inline Outcome run_program(const std::filesystem::path& folder, const std::string& arguments,
                           const std::string& environment = "") {
    return run_command(folder, environment + " '" + CELLPROJ_PROGRAM + "' " + arguments);
}

}  // namespace cellproj::testing_support
