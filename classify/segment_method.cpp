// SPDX-License-Identifier: BSD-3-Clause
#include "classify/segment_method.hpp"

#include <cassert>

#include "classify/piece_table.hpp"
#include "classify/preintegration_table.hpp"

namespace cellproj {

namespace {

class Preint3d : public SegmentMethod {
public:
    Preint3d(const Method& method, const TransferFunction& transfer, double max_length)
        : table_(transfer, {0.0, 1.0, max_length}, method.size) {}

    Light light(double s_f, double s_b, double length) const override { return table_.lookup(s_f, s_b, length); }
    std::size_t table_bytes() const override { return table_.texels().size() * sizeof(float); }

private:
    PreintegrationTable table_;
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
                                                   double max_length, [[maybe_unused]] double mean_length) {
    assert(max_length > 0.0 && mean_length > 0.0);
    switch (method.kind) {
        case MethodKind::preint3d:
            return std::make_unique<Preint3d>(method, transfer, max_length);
        case MethodKind::integral:
        case MethodKind::exact:
            return std::make_unique<PieceWalk>(method, transfer, max_length);
        default:
            assert(false && "no such method");
            return nullptr;
    }
}

}  // namespace cellproj
