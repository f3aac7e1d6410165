// SPDX-License-Identifier: BSD-3-Clause
//
// A method of method.hpp, ready to turn segments into light. The renderers compute the same from the same tables in
// float32; here it is float64, for tests and for light at vertices.
//
// Scalars and lengths are in scene units (SceneUnits in render/prepared_scene.hpp, in_scene_units below): scalars 0..1
// over the field's finite range, lengths up to `max_length`.
#pragma once

#include <cstddef>
#include <memory>

#include "classify/method.hpp"
#include "classify/transfer_function.hpp"

namespace cellproj {

class SegmentMethod {
public:
    virtual ~SegmentMethod() = default;

    // Light of a segment from s_f (front) to s_b; both are clamped to 0..1, 0 ≤ length ≤ max_length; none may be NaN.
    // Finite, colours ≥ 0 and opacity in 0..1 whatever comes in.
    virtual Light light(double s_f, double s_b, double length) const = 0;

    // What its tables take in memory [bytes].
    virtual std::size_t table_bytes() const = 0;
};

// `transfer` in scene units. max_length > 0: no segment is longer; mean_length > 0: what most are like, which preint2d
// is made for.
std::unique_ptr<SegmentMethod> make_segment_method(const Method& method, const TransferFunction& transfer,
                                                   double max_length, double mean_length);

// The same function with scalar_low .. scalar_high as 0..1 and `length` as the unit of length: emission and extinction
// per that unit. Where the range is empty (scalar_low = scalar_high), its value there, everywhere. Nodes that coincide
// in the new scale keep the outermost two.
TransferFunction in_scene_units(const TransferFunction& transfer, double scalar_low, double scalar_high, double length);

// The same where colour and extinction are functions of two scalars, each with its own range as 0..1.
struct ScalarSpan {
    double low, high;  // finite, low ≤ high
};
TransferFunction in_scene_units(const TransferFunction& transfer, ScalarSpan color, ScalarSpan extinction, double length);

}  // namespace cellproj
