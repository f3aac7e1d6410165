// SPDX-License-Identifier: BSD-3-Clause
//
// Suites that hold in parallel views and in perspective:
//   INSTANTIATE_TEST_SUITE_P(Name, Suite, either_projection, name_of_projection);
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "project/camera.hpp"

namespace cellproj::testing_support {

inline std::string name_of(Camera::Projection projection) { return projection == Camera::Projection::parallel ? "parallel" : "perspective"; }

inline const auto either_projection = testing::Values(Camera::Projection::parallel, Camera::Projection::perspective);
inline const auto name_of_projection = [](const testing::TestParamInfo<Camera::Projection>& info) { return name_of(info.param); };

}  // namespace cellproj::testing_support
