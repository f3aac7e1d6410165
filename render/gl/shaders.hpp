// SPDX-License-Identifier: BSD-3-Clause
//
// The texts of the shader files in render/gl/shaders, embedded at build time (embed_shaders.cmake).
#pragma once

#include <string>

namespace cellproj::gl::shaders {

extern const std::string cell_vert;         // needs a prepare_cell behind it
extern const std::string cell_frag;         // needs light_glsl and a light_of_segment behind it
extern const std::string surfaces_vert;     // needs a prepare_cell behind it
extern const std::string surfaces_frag;     // needs reflected_glsl behind it; with a medium: what cell_frag needs, with a lit one lit_medium_glsl
extern const std::string reflected_glsl;
extern const std::string lit_medium_glsl;   // with a lit medium behind surfaces_frag or grid_light_glsl, and reflected_glsl
extern const std::string grid_light_glsl;   // between grid_rays_frag and what follows; where something is lit, needs reflected_glsl behind it
extern const std::string grid_surfaces_glsl;  // with surfaces, behind grid_light_glsl
extern const std::string light_glsl;
extern const std::string grid_place_vert;   // needs grid_cell_vert or grid_lit_vert behind it
extern const std::string grid_cell_vert;    // behind grid_place_vert; needs a prepare_cell behind it
extern const std::string grid_lit_vert;     // behind grid_place_vert; needs light_glsl, a prepare_cell and a light_of_segment behind it
extern const std::string grid_lit_frag;
extern const std::string grid_open_vert, grid_open_frag;  // grid_closed_tiles.hpp
extern const std::string grid_rays_frag;    // needs grid_cell_frag or grid_slab_frag behind it
extern const std::string grid_slab_vert;
extern const std::string grid_slab_frag;    // as grid_cell_frag
extern const std::string grid_cell_frag;    // behind grid_rays_frag; needs light_glsl and a light_of_segment behind it
extern const std::string no_cell_glsl;      // a prepare_cell that does nothing
extern const std::string sampled_glsl;   // behind it: average, homogeneous, linear or stein
extern const std::string average_glsl;
extern const std::string homogeneous_glsl;
extern const std::string linear_glsl;
extern const std::string stein_glsl;
extern const std::string preint2d_glsl;
extern const std::string preint2d_exp_glsl;
extern const std::string pieces_glsl;       // integral and exact: what the next three share
extern const std::string pieces_cell_glsl;  // prepare_cell for
extern const std::string pieces_all_glsl;   // few pieces, one by one
extern const std::string pieces_walk_glsl;  // many pieces, thin ones at once; needs no prepare_cell
extern const std::string pieces_two_fields_glsl;  // colour and extinction over two fields; needs no prepare_cell
extern const std::string preint3d_glsl;
extern const std::string preint3d_linear_glsl;
extern const std::string lit_vert;
extern const std::string lit_frag;

}  // namespace cellproj::gl::shaders
