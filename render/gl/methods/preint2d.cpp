// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "classify/mean_tables.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/shaders.hpp"
#include "render/gl/textures.hpp"

namespace cellproj::gl {

namespace {

template <class Table>
class Preint2dShader : public SegmentShader {
public:
    Preint2dShader(const std::string& source, Table table)
        : source_(source), table_(std::move(table)), texture_(upload(table_)) {}

    const std::string& source() const override { return source_; }

    bool update(const TransferFunction& transfer) override {
        if (table_.update(transfer) > 0) texture_ = upload(table_);
        return true;
    }

    void bind(const Program& program) const override {
        program.set("table_size", static_cast<float>(table_.size()));
        program.set("table_range", table_.encoding().range());
        set_own(program, table_);
        texture_.bind(0);
    }

    std::size_t table_bytes() const override { return texture_.bytes(); }

private:
    static Texture upload(const Table& table) {
        const TableEncoding& encoding = table.encoding();
        return Texture::table_2d(table.size(), encoding.storage(), encoding.stored(table.texels()));
    }
    static void set_own(const Program& program, const MeanLengthTable& table) {
        program.set("inverse_mean_length", static_cast<float>(1.0 / table.mean_length()));
    }
    static void set_own(const Program&, const MeanValueTable&) {}

    std::string source_;
    Table table_;
    Texture texture_;
};

}  // namespace

std::unique_ptr<SegmentShader> make_preint2d_shader(const Method& method, const TransferFunction& transfer,
                                                    double mean_length) {
    return std::make_unique<Preint2dShader<MeanLengthTable>>(
        shaders::preint2d_glsl, MeanLengthTable(transfer, mean_length, method.size, method.storage));
}

std::unique_ptr<SegmentShader> make_preint2d_exp_shader(const Method& method, const TransferFunction& transfer) {
    return std::make_unique<Preint2dShader<MeanValueTable>>(shaders::preint2d_exp_glsl,
                                                            MeanValueTable(transfer, method.size, method.storage));
}

}  // namespace cellproj::gl
