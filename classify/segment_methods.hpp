// SPDX-License-Identifier: BSD-3-Clause
//
// One maker per family of methods, for make_segment_method. Private to classify/.
#pragma once

#include <memory>

#include "classify/segment_method.hpp"

namespace cellproj {

// average, homogeneous, linear, stein: from samples of the function along the segment.
std::unique_ptr<SegmentMethod> make_sampled_method(const Method& method, const TransferFunction& transfer);

// preint2d, preint2d_exp, preint3d.
std::unique_ptr<SegmentMethod> make_table_method(const Method& method, const TransferFunction& transfer,
                                                 double max_length, double mean_length);

}  // namespace cellproj
