// SPDX-License-Identifier: BSD-3-Clause
//
// From scalar to light. A transfer function gives emission q(s) [radiance / length] and extinction τ(s) [1 / length],
// each piecewise linear or, in the density model, the product of two piecewise-linear functions:
//
//   density (Williams and Max; RKE00 Eq. 1)  q(s) = κ(s)·τ(s), κ the chromaticity ("color"), τ the density
//   emitter (WVG91)                          q(s) given directly ("color"), τ(s) independent of it
//
// All colours that leave classify/ are associated (premultiplied by opacity), display-referred, without hidden gamma.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace cellproj {

enum class OpticalModel { density, emitter };

// How opacity α per unit distance u becomes extinction: exponential τ = −ln(1 − α)/u (WVG91 Eq. 2), or linear τ = α/u,
// which VTK's projected tetrahedra uses.
enum class OpacityConvention { exponential, linear };

// What holds outside the first and the last node: their values, or nothing (q = τ = 0).
enum class Outside { clamp, transparent };

// What the function is linear in between two nodes: the scalar s, or ln s. In a cell s stays linear either way.
enum class ScalarAxis { linear, log };

struct ColorNode {
    double scalar;
    glm::dvec3 color;
};

struct ExtinctionNode {
    double scalar;
    double extinction;  // ≥ 0 [1 / mesh unit]
};

struct OpacityNode {
    double scalar;
    double opacity;  // 0..1 per unit distance
};

// Light of a piece of a ray: associated colour and opacity.
struct Light {
    glm::dvec3 color{0.0};
    double opacity = 0.0;
};

// The function between two neighbouring breakpoints, where colour and extinction are linear in s. The values at the
// ends are limits from inside, so that a step belongs to neither side. The outermost pieces are constant and reach to
// ∓infinity.
struct LinearPiece {
    double begin, end;  // scalars, begin < end
    glm::dvec3 color_begin, color_end;
    double extinction_begin, extinction_end;

    // Where s lies between the ends, 0..1; 0 in a piece without end.
    double fraction(double s) const;
    glm::dvec3 color(double s) const;
    double extinction(double s) const;
};

// Two nodes at one scalar make a step; the value at the step itself is that of the right side. With
// Outside::transparent the first and the last node still count as inside. Immutable; copies are independent values.
class TransferFunction {
public:
    // Nodes by ascending scalar, at least one each, at most two at one scalar, all finite, colours and extinctions ≥ 0.
    // |scalar| ≤ 1e150 and colours and extinctions ≤ 1e60, so that no product of theirs with a length overflows.
    // Throws Error (data), naming `place`, the node (counted from 0) and what is wrong with it.
    TransferFunction(OpticalModel model, std::vector<ColorNode> color, std::vector<ExtinctionNode> extinction,
                     Outside outside = Outside::clamp, const std::string& place = "transfer function");

    OpticalModel model() const { return model_; }
    Outside outside() const { return outside_; }
    const std::vector<ColorNode>& color_nodes() const { return color_; }
    const std::vector<ExtinctionNode>& extinction_nodes() const { return extinction_; }

    glm::dvec3 color(double s) const;     // κ(s) or, in the emitter model, q(s)
    double extinction(double s) const;    // τ(s)
    glm::dvec3 emission(double s) const;  // q(s)

    // Every scalar at which the colour or the extinction has a node, ascending, each once.
    const std::vector<double>& breakpoints() const { return breakpoints_; }
    // One piece more than breakpoints: pieces()[i] ends at breakpoints()[i], the last one at infinity.
    const std::vector<LinearPiece>& pieces() const { return pieces_; }

    // Exact ∫ τ ds over [a, b], a ≤ b.
    double extinction_integral(double a, double b) const;
    // Largest τ and whether anything can be seen (τ > 0 or q > 0) for scalars in [a, b], a ≤ b.
    double max_extinction(double a, double b) const;
    bool visible(double a, double b) const;

private:
    OpticalModel model_;
    std::vector<ColorNode> color_;
    std::vector<ExtinctionNode> extinction_;
    Outside outside_;
    std::vector<double> breakpoints_;
    std::vector<LinearPiece> pieces_;
    // ∫ τ from the first breakpoint to each, as the unevaluated sum of two float64: a weak part of the function keeps
    // its digits in the difference of two values even behind a part 1e16 times as strong.
    struct RunningIntegral {
        double sum, rest;
    };
    std::vector<RunningIntegral> cumulative_extinction_;
};

// The scalar at a share 0..1 of the way from `low` to `high` along the axis, within low..high; low ≤ high, both > 0 on a
// logarithmic axis.
double scalar_between(double low, double high, double share, ScalarAxis axis);

// Nodes whose straight lines in s follow a function that is linear between `nodes` along the axis: on a logarithmic one
// nodes are inserted until every line is within 1e-3 of the change from node to node (a decade takes 17 lines); the given
// nodes stay as they are. Throws Error (data) naming `place` and the node: as TransferFunction does, and for a scalar ≤ 0 on a
// logarithmic axis.
std::vector<ColorNode> on_axis(std::vector<ColorNode> nodes, ScalarAxis axis, const std::string& place = "transfer function");
std::vector<ExtinctionNode> on_axis(std::vector<ExtinctionNode> nodes, ScalarAxis axis,
                                    const std::string& place = "transfer function");

// The same function with `factor` times its extinction, factor ≥ 0: thicker or thinner. In the density model the emission goes
// with it. Throws Error (data) when an extinction grows past 1e60.
TransferFunction with_scaled_extinction(const TransferFunction& function, double factor);

// The two parts of a function by themselves, for who reads them over two scalars: what shines as `color` says and absorbs nothing (an
// emitter), and what absorbs and is black.
TransferFunction color_alone(const TransferFunction& function);
TransferFunction extinction_alone(const TransferFunction& function);

// Extinction nodes for an opacity that is linear between its nodes along the axis. With the exponential convention τ(s) is
// curved between nodes: nodes are inserted until the piecewise-linear τ·u is within 1e-3 of −ln(1 − α) everywhere. α = 1 would
// be an infinite extinction; it counts as 1 − 2⁻²⁴, the last opacity that float32 can tell from 1. Where float64 has no scalar left
// between two nodes nothing can be inserted. On a logarithmic axis the lines of `on_axis` come on top. Throws Error (data) for
// an opacity outside 0..1, a bad order of nodes or a scalar ≤ 0 on a logarithmic axis, Error (option) unless unit_distance > 0
// [mesh units].
std::vector<ExtinctionNode> extinction_from_opacity(const std::vector<OpacityNode>& opacity, double unit_distance,
                                                    OpacityConvention convention,
                                                    const std::string& place = "transfer function",
                                                    ScalarAxis axis = ScalarAxis::linear);

// The strict JSON of the design: "color", or "preset" (presets.hpp) with "range"; "extinction", or "opacity" with
// "unit_distance"; "model" (density unless given), "opacity_convention" (exponential), "outside" (clamp) and "axis" (linear).
// Throws Error (format, option, data) naming `place` and the key.
//
// ParaView's exported colour maps are read as well: colour spaces RGB, HSV (with "HSVWrap"), Lab, Diverging and Step, opacity
// points included in the export; "UseLogScale" makes the axis of both logarithmic. Curved colours become straight lines within
// 1e-3. They do not tell the unit distance of their opacity: it is taken from a key "unit_distance" added beside
// "Points", else from `paraview_unit_distance` [mesh units]. ParaView itself starts with the bounding box's diagonal
// divided by ∛(number of cells). Of a list of several maps the one of "Name" `map_name` is taken.
TransferFunction parse_transfer_function(std::string_view json, const std::string& place, double paraview_unit_distance = 1.0,
                                         std::string_view map_name = {});
// FILE, or FILE#NAME for one map of several (a file whose own name holds a # comes first). Throws Error (file) besides, when
// the file cannot be read.
TransferFunction read_transfer_function(const std::filesystem::path& file, double paraview_unit_distance = 1.0);

// A first picture for scalars in low..high of a mesh `size` [mesh units] across: the colours of a preset (presets.hpp), and an
// extinction that rises from 0 along the axis so that a path through the whole mesh at the highest scalar has optical depth 8.
// low ≤ high; a constant field gets the highest scalar's light; size 0 counts as 1. Throws Error: (option) for an unknown
// preset, (data) where `on_axis` does.
TransferFunction default_transfer_function(double low, double high, double size, std::string_view colors = "viridis",
                                           ScalarAxis axis = ScalarAxis::linear);

}  // namespace cellproj
