// SPDX-License-Identifier: BSD-3-Clause
#include "classify/piece_table.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/shaders.hpp"
#include "render/gl/textures.hpp"

namespace cellproj::gl {

namespace {

class PieceShader : public SegmentShader {
public:
    PieceShader(const PieceTable& table, const WalkLimits& limits)
        : limits_(limits),
          is_density_(table.model == OpticalModel::density),
          bin_count_(table.bin_count()),
          pieces_(Texture::list(table.pieces)),
          bins_(Texture::list(table.bins)) {}

    const std::string& source() const override {
        static const std::string all = shaders::pieces_glsl + shaders::pieces_all_glsl;
        static const std::string blocks = shaders::pieces_glsl + shaders::pieces_walk_glsl;
        return limits_.takes_blocks() ? blocks : all;
    }
    const std::string& vertex_source() const override {
        static const std::string all = shaders::pieces_glsl + shaders::pieces_cell_glsl;
        return limits_.takes_blocks() ? shaders::no_cell_glsl : all;
    }

    void bind(const Program& program) const override {
        program.set("bin_count", static_cast<float>(bin_count_));
        program.set("is_density", is_density_ ? 1.0F : 0.0F);
        program.set("step_depth", static_cast<float>(limits_.step_depth));
        if (limits_.takes_blocks()) program.set("block_depth", static_cast<float>(limits_.block_depth));
        program.set("deepest", static_cast<float>(limits_.deepest));
        pieces_.bind(0);
        bins_.bind(1);
    }

    std::size_t table_bytes() const override { return pieces_.bytes() + bins_.bytes(); }

private:
    WalkLimits limits_;
    bool is_density_;
    std::size_t bin_count_;
    Texture pieces_, bins_;
};

class TwoFieldPieceShader : public SegmentShader {
public:
    TwoFieldPieceShader(const TransferFunction& transfer, const WalkLimits& limits)
        : limits_(limits),
          is_density_(transfer.model() == OpticalModel::density),
          color_(make_piece_table(color_alone(transfer))),
          opacity_(make_piece_table(extinction_alone(transfer))) {}

    const std::string& source() const override {
        static const std::string text = shaders::pieces_glsl + shaders::pieces_two_fields_glsl;
        return text;
    }

    void bind(const Program& program) const override {
        program.set("bin_count", color_.bin_count);
        program.set("opacity_bin_count", opacity_.bin_count);
        program.set("is_density", is_density_ ? 1.0F : 0.0F);
        program.set("step_depth", static_cast<float>(limits_.step_depth));
        program.set("deepest", static_cast<float>(limits_.deepest));
        color_.pieces.bind(0);
        color_.bins.bind(1);
        opacity_.pieces.bind(2);
        opacity_.bins.bind(3);
    }

    std::size_t table_bytes() const override {
        return color_.pieces.bytes() + color_.bins.bytes() + opacity_.pieces.bytes() + opacity_.bins.bytes();
    }

private:
    struct Uploaded {
        explicit Uploaded(const PieceTable& table)
            : bin_count(static_cast<float>(table.bin_count())), pieces(Texture::list(table.pieces)), bins(Texture::list(table.bins)) {}

        float bin_count;
        Texture pieces, bins;
    };

    WalkLimits limits_;
    bool is_density_;
    Uploaded color_, opacity_;
};

}  // namespace

std::unique_ptr<SegmentShader> make_piece_shader(const Method& method, const TransferFunction& transfer, FieldsRead fields,
                                                 double max_length) {
    const PieceTable table = make_piece_table(transfer);
    if (fields == FieldsRead::two)
        return std::make_unique<TwoFieldPieceShader>(transfer, walk_limits(method, table, max_length));
    return std::make_unique<PieceShader>(table, walk_limits(method, table, max_length));
}

}  // namespace cellproj::gl
