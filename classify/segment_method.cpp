// SPDX-License-Identifier: BSD-3-Clause
#include "classify/segment_method.hpp"

#include <cassert>

#include "classify/segment_methods.hpp"

namespace cellproj {

std::unique_ptr<SegmentMethod> make_segment_method(const Method& method, const TransferFunction& transfer,
                                                   double max_length, double mean_length) {
    assert(max_length > 0.0 && mean_length > 0.0);
    switch (method.kind) {
        case MethodKind::average:
        case MethodKind::homogeneous:
        case MethodKind::linear:
        case MethodKind::stein:
            return make_sampled_method(method, transfer);
        case MethodKind::preint2d:
        case MethodKind::preint2d_exp:
        case MethodKind::preint3d:
            return make_table_method(method, transfer, max_length, mean_length);
        default:
            assert(false && "no such method");
            return nullptr;
    }
}

}  // namespace cellproj
