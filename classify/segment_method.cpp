// SPDX-License-Identifier: BSD-3-Clause
#include "classify/segment_method.hpp"

#include <cassert>
#include <utility>

#include "classify/half_opacity.hpp"
#include "classify/piece_table.hpp"
#include "classify/segment_methods.hpp"
#include "classify/shirley_tuchman.hpp"

namespace cellproj {

namespace {

// Another method, blended in three passes.
class HalfOpacity : public SegmentMethod {
public:
    explicit HalfOpacity(std::unique_ptr<SegmentMethod> method) : method_(std::move(method)) {}

    Light light(double s_f, double s_b, double length) const override {
        return half_opacity(method_->light(s_f, s_b, length));
    }
    std::size_t table_bytes() const override { return method_->table_bytes(); }

private:
    std::unique_ptr<SegmentMethod> method_;
};

class PieceWalk : public SegmentMethod {
public:
    PieceWalk(const Method& method, const TransferFunction& transfer, double max_length)
        : table_(make_piece_table(transfer)), limits_(walk_limits(method, table_, max_length)) {}

    Light light(double s_f, double s_b, double length) const override {
        return walk_segment(table_, limits_, s_f, s_b, length);
    }
    std::size_t table_bytes() const override { return table_.bytes(); }

private:
    PieceTable table_;
    WalkLimits limits_;
};

}  // namespace

std::unique_ptr<SegmentMethod> make_segment_method(const Method& method, const TransferFunction& transfer,
                                                   double max_length, double mean_length) {
    assert(max_length > 0.0 && mean_length > 0.0);
    if (method.blending == Blending::half) {
        Method once = method;
        once.blending = Blending::once;
        return std::make_unique<HalfOpacity>(make_segment_method(once, transfer, max_length, mean_length));
    }
    switch (method.kind) {
        case MethodKind::shirley_tuchman:
            return std::make_unique<ShirleyTuchman>(transfer);
        case MethodKind::average:
        case MethodKind::homogeneous:
        case MethodKind::linear:
        case MethodKind::stein:
            return make_sampled_method(method, transfer);
        case MethodKind::preint2d:
        case MethodKind::preint2d_exp:
        case MethodKind::preint3d:
            return make_table_method(method, transfer, max_length, mean_length);
        case MethodKind::integral:
        case MethodKind::exact:
            return std::make_unique<PieceWalk>(method, transfer, max_length);
        default:
            assert(false && "no such method");
            return nullptr;
    }
}

}  // namespace cellproj
