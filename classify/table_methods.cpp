// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>
#include <utility>

#include "classify/mean_tables.hpp"
#include "classify/preintegration_table.hpp"
#include "classify/segment_methods.hpp"

namespace cellproj {

namespace {

template <class Table>
class TableMethod : public SegmentMethod {
public:
    explicit TableMethod(Table table) : table_(std::move(table)) {}

    Light light(double s_f, double s_b, double length) const override { return table_.lookup(s_f, s_b, length); }
    std::size_t table_bytes() const override {
        return table_.texels().size() / 4 * bytes_per_texel(table_.encoding().storage());
    }

private:
    Table table_;
};

}  // namespace

std::unique_ptr<SegmentMethod> make_table_method(const Method& method, const TransferFunction& transfer,
                                                 double max_length, double mean_length) {
    if (method.kind == MethodKind::preint2d)
        return std::make_unique<TableMethod<MeanLengthTable>>(
            MeanLengthTable(transfer, mean_length, method.size, method.storage));
    if (method.kind == MethodKind::preint2d_exp)
        return std::make_unique<TableMethod<MeanValueTable>>(MeanValueTable(transfer, method.size, method.storage));
    assert(method.kind == MethodKind::preint3d);
    return std::make_unique<TableMethod<PreintegrationTable>>(
        PreintegrationTable(transfer, {0.0, 1.0, max_length}, method.size, method.scale, method.storage));
}

}  // namespace cellproj
