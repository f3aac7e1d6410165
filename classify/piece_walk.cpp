// SPDX-License-Identifier: BSD-3-Clause
//
// render/gl/shaders/pieces_walk.glsl line by line, in float64; pieces_all.glsl is its case without blocks. A change here
// needs the same there.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "classify/optics.hpp"
#include "classify/piece_table.hpp"
#include "classify/segment_path.hpp"

namespace cellproj {

namespace {

class Walk {
public:
    Walk(const PieceTable& table, const WalkLimits& limits, float s_f, float s_b, double length)
        : table_(table), limits_(limits), from_(s_f), to_(s_b), range_(std::abs(to_ - from_)), length_(length),
          rising_(s_f <= s_b) {}

    Light light() {
        const auto step = rising_ ? std::ptrdiff_t{1} : std::ptrdiff_t{-1};
        auto piece = static_cast<std::ptrdiff_t>(table_.piece_of(static_cast<float>(from_)));
        std::ptrdiff_t last = -1;  // looked up when it is needed
        double s = from_;
        for (int parts = 1;; ++parts) {
            const glm::dvec4 ends = table_.texel(static_cast<std::size_t>(piece), 0);
            const double end = rising_ ? std::min(ends.y, to_) : std::max(ends.x, to_);
            add_part(static_cast<std::size_t>(piece), s, end);
            if (end == to_ || depth_ >= limits_.deepest) break;
            piece += step;
            s = end;
            if (!limits_.takes_blocks() || parts < 2) continue;  // most segments end in this piece
            if (last < 0) last = static_cast<std::ptrdiff_t>(table_.piece_of(static_cast<float>(to_)));
            // The most pieces, by halving, that are thin enough together.
            for (std::ptrdiff_t count = (last - piece) * step; count > 1; count /= 2) {
                const std::ptrdiff_t begin = rising_ ? piece : piece + 1;
                if (!add_block(static_cast<std::size_t>(begin), static_cast<std::size_t>(begin + count * step))) continue;
                piece += count * step;
                s = table_.texel(static_cast<std::size_t>(rising_ ? piece : piece + 1), 0).x;
                break;
            }
        }
        return {color_, opacity_of_depth(depth_)};
    }

private:
    // From s to `end`, both inside the piece: steps of equal optical depth, found by solving D(t) = depth·((1 − r)·t + r·t²),
    // a Gauss rule in each.
    void add_part(std::size_t piece, double s, double end) {
        const glm::dvec4 ends = table_.texel(piece, 0);
        const double width = ends.y - ends.x;
        const double t0 = (s - ends.x) / width, t1 = (end - ends.x) / width;
        const double tau0 = ends.z * (1.0 - t0) + ends.w * t0, tau1 = ends.z * (1.0 - t1) + ends.w * t1;
        const double part = range_ > 0.0 ? length_ * (std::abs(end - s) / range_) : length_;
        const double depth = part * 0.5 * (tau0 + tau1);
        const double r = depth > 0.0 ? (tau1 - tau0) / (tau1 + tau0) : 0.0;
        const double steps = std::max(1.0, std::ceil(depth / limits_.step_depth));
        double weight0 = 0.0, weight1 = 0.0;  // of the colours at s and at `end`
        double begin = 0.0;
        for (double k = 1.0;; ++k) {
            const double share = k / steps;
            const double root = std::sqrt(std::max(0.0, (1.0 - r) * (1.0 - r) + 4.0 * r * share));
            const double behind = k < steps ? std::min(1.0, 2.0 * share / (1.0 - r + root)) : 1.0;
            for (std::size_t i = 0; i < shallow_table_rule.position.size(); ++i) {
                const double t = begin + (behind - begin) * shallow_table_rule.position[i];
                const double q = table_.model == OpticalModel::density ? depth * (1.0 - r + 2.0 * r * t) : part;
                const double light = q * (behind - begin) * shallow_table_rule.weight[i] *
                                     std::exp(-depth_ - depth * t * (1.0 - r + r * t));
                weight0 += light * (1.0 - t);
                weight1 += light * t;
            }
            begin = behind;
            if (k >= steps || depth_ + depth * share >= limits_.deepest) break;
        }
        const glm::dvec3 c0(table_.texel(piece, 1)), c1(table_.texel(piece, 2));
        color_ += weight0 * glm::mix(c0, c1, t0) + weight1 * glm::mix(c0, c1, t1);
        depth_ += depth;
    }

    // The whole pieces between the begins of two, at once, unless they are too thick.
    bool add_block(std::size_t a, std::size_t b) {
        const double width = std::abs(table_.texel(b, 0).x - table_.texel(a, 0).x);
        const glm::dvec4 sum = glm::abs((table_.texel(b, 3) - table_.texel(a, 3)) + (table_.texel(b, 4) - table_.texel(a, 4)));
        const glm::dvec4 block = sum / width * (length_ * (width / range_));  // ∫ q dx, ∫ τ dx along the segment
        if (block.w > limits_.block_depth) return false;
        color_ += glm::dvec3(block) * (mean_transmittance(block.w) * std::exp(-depth_));
        depth_ += block.w;
        return true;
    }

    const PieceTable& table_;
    const WalkLimits& limits_;
    double from_, to_, range_, length_;
    bool rising_;
    glm::dvec3 color_{0.0};
    double depth_ = 0.0;  // so far
};

}  // namespace

Light walk_segment(const PieceTable& table, const WalkLimits& limits, double s_f, double s_b, double length) {
    const auto scalar = [](double s) { return static_cast<float>(std::clamp(s, 0.0, 1.0)); };
    return Walk(table, limits, scalar(s_f), scalar(s_b), length).light();
}

}  // namespace cellproj
