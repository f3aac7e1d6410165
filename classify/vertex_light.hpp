// SPDX-License-Identifier: BSD-3-Clause
//
// Light at the vertices of the classical split of a cell (project/tet_projection.hpp), for the rasterizer to interpolate
// linearly on the screen. Only at the thick vertex does a ray have a way through the cell; at the others, on the
// silhouette, opacity and light are 0. Between them linear interpolation is an approximation: of the length, which is
// linear there in parallel views, and of everything else, which is not.
//
// What is interpolated is a colour, and by itself the share t that the thick vertex has of the pixel (1 there, 0 on the
// silhouette); the pixel's light is
//
//   associated colour = colour · weight · t,   opacity = opacity · t      with weight and opacity of the thick vertex
//
//   shirley-tuchman     Shirley and Tuchman 1990: colour and opacity are interpolated separately, so that the associated
//                       colour is quadratic in between; colours at the silhouette are those of the scalar there
//   NAME:vertices       WVG91's Gouraud interpolation: the associated colour is linear (the colour is that of the thick
//                       vertex everywhere, the weight 1)
#pragma once

#include <cstddef>
#include <memory>

#include "classify/method.hpp"
#include "classify/transfer_function.hpp"

namespace cellproj {

struct VertexLight {
    glm::dvec3 color{0.0};
    double weight = 0.0;
    double opacity = 0.0;

    Light light() const { return {color * weight, opacity}; }
};

class VertexLighting {
public:
    virtual ~VertexLighting() = default;

    // Of the segment through the thick vertex, front to back. Scalars in 0..1 and the length in 0..max_length (both are
    // clamped), scene units as for SegmentMethod. Finite, nothing negative, opacity in 0..1.
    virtual VertexLight at_thick_vertex(double s_f, double s_b, double length) const = 0;

    // The colour that is interpolated from a silhouette vertex with scalar s to the given thick vertex.
    virtual glm::dvec3 color_at_silhouette(double s, const VertexLight& thick) const = 0;

    virtual std::size_t table_bytes() const = 0;  // [bytes]
};

// For a method whose light is computed at vertices (light_at_vertices in method.hpp); the other parameters are those of
// make_segment_method, which gives the light at the thick vertex.
std::unique_ptr<VertexLighting> make_vertex_lighting(const Method& method, const TransferFunction& transfer,
                                                     double max_length, double mean_length);

}  // namespace cellproj
