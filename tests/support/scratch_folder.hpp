// SPDX-License-Identifier: BSD-3-Clause
//
// Where tests write files.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

namespace cellproj::testing_support {

// A folder of this process alone, gone when it ends: programs that run the same tests at the same time (two builds on one machine)
// would empty each other's.
class ProcessFolder {
public:
    ProcessFolder() : owner_(getpid()) {
        std::string name = (std::filesystem::path(testing::TempDir()) / "cellproj_tests_XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::system_error(errno, std::generic_category(), name);
        path_ = name;
    }
    ~ProcessFolder() {
        std::error_code left_behind;
        if (getpid() == owner_) std::filesystem::remove_all(path_, left_behind);  // not in children
    }
    ProcessFolder(const ProcessFolder&) = delete;
    ProcessFolder& operator=(const ProcessFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
    pid_t owner_;
};

// The folder of the case that runs; made when it is not there.
inline std::filesystem::path scratch_folder() {
    static const ProcessFolder all;
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "." + test->name();
    std::replace(name.begin(), name.end(), '/', '.');  // of cases with parameters
    const std::filesystem::path folder = all.path() / name;
    std::filesystem::create_directories(folder);
    return folder;
}

}  // namespace cellproj::testing_support
