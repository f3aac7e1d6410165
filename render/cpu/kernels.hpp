// SPDX-License-Identifier: BSD-3-Clause
//
// The inner loops of the CPU renderer, compiled once for each instruction set and chosen when the program runs. Plain arrays in,
// pixels out; threads and memory are the caller's business.
//
// Screen coordinates here are pixels relative to the middle of the picture: pixel (i, j) has its centre at
// (i + ½ − width/2, j + ½ − height/2), which float32 holds exactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "mesh/tet_mesh.hpp"
#include "render/cpu/method_tables.hpp"
#include "render/cpu/piece_arrays.hpp"
#include "render/cpu/screen_surfaces.hpp"

namespace cellproj::cpu {

inline constexpr int tile_side = 32;                       // pixels; a tile's colours are 16 KB
inline constexpr int region_side = 32;                     // tiles; a region is what cells are binned for at once
inline constexpr int tiles_per_region = region_side * region_side;

// A vertex as the tiles see it. Nearness grows towards the eye and is affine on the screen over any plane: in perspective
// 1/depth − View::base_nearness, in parallel views −depth relative to the mesh's middle; depth in scene units.
struct ScreenPoint {
    float x, y, nearness;
    float scalar;  // 0..1; unused for fields on cells
};
static_assert(sizeof(ScreenPoint) == 16);

// The nearness of points that perspective cannot show: behind the near plane. Cells with such a corner are cut before.
inline constexpr float behind_near_plane = 1e30F;

struct View {
    int width = 0, height = 0;
    bool perspective = false;
    float base_nearness = 0;      // perspective: 1/depth of nearness 0, so that differences keep their digits far away
    float near_plane = 0;         // perspective: 1/depth from which on a segment begins at the eye (cut cells)
    float unit_per_pixel = 0;     // perspective: on the plane at depth 1
};

// What of a pixel's ray is drawn, of the nearness of ScreenPoint: near ≥ n ≥ far.
struct NearnessInterval {
    static constexpr float unbounded = 1e30F;
    float near = unbounded, far = -unbounded;

    static constexpr NearnessInterval nothing() { return {-unbounded, unbounded}; }
};

// What is drawn. An item below #T is a cell, item #T + i is extra[i]: parts of cells that were cut, with points of their own.
struct ScreenCells {
    View view;
    std::span<const ScreenPoint> points;
    std::span<const std::array<VertexId, 4>> tets;   // #T, positively oriented
    std::span<const std::array<VertexId, 4>> extra;
    std::span<const float> cell_scalars;             // #T + #extra, 0..1; empty for fields on points
    std::span<const std::uint8_t> visible;           // #T, 0 for cells that are left out; empty when there are none
    const ScreenSurfaces* surfaces = nullptr;        // null: no isosurfaces

    const std::array<VertexId, 4>& corners(std::uint32_t item) const {
        return item < tets.size() ? tets[item] : extra[item - tets.size()];
    }
};

// Which tiles of a region a cell's box meets: first and last column and row. No pixel centre: first_x > last_x.
struct TileBox {
    std::uint32_t first_x : 6 = 1, first_y : 6 = 1, last_x : 6 = 0, last_y : 6 = 0;
    std::uint32_t begins : 1 = 0;  // the box meets no region to the left or above
};
static_assert(sizeof(TileBox) == 4);

// The part of the picture at (x, y) [pixels], up to region_side tiles wide and high.
struct Region {
    int x, y, width, height;  // pixels
};

// The boxes of items first .. end − 1, into boxes[item]; empty for cells that are not visible.
void find_boxes(const ScreenCells& cells, const Region& region, std::size_t first, std::size_t end, std::span<TileBox> boxes);
// The same of these items alone.
void find_boxes(const ScreenCells& cells, const Region& region, std::span<const std::uint32_t> items, std::span<TileBox> boxes);

// How a segment becomes light: by the pieces of the transfer function or by the tables of a method, one of both.
struct Shading {
    const PieceArrays* pieces = nullptr;
    const MethodTables* tables = nullptr;
    bool half_opacity = false;  // Blending::half
    float opaque = 1;           // behind a larger opacity nothing is drawn; 1: everything is
};

// The light of segments as tiles compute it: scalars 0..1, lengths ≥ 0 in scene units, as many of each. `constant`: as for fields
// on cells, s_f = s_b.
void light_of_segments(const Shading& shading, bool constant, std::span<const float> s_f, std::span<const float> s_b,
                       std::span<const float> length, std::span<glm::vec4> light);

// The part of the picture that one task draws.
struct Tile {
    int x, y, width, height;  // pixels, in the picture; up to tile_side each
    glm::vec4* pixels;        // the picture's pixel (x, y)
    std::size_t stride;       // pixels from row to row
    std::uint8_t* full = nullptr;  // set to 1 when nothing more can be seen behind what the tile holds
    PixelTrail* trails = nullptr;  // with isosurfaces: of the pixels, from one drawing of the tile to the next; `stride` as theirs
    const NearnessInterval* windows = nullptr;  // of the pixels, `stride` as theirs; null: all of every ray
};

// Composites items, given from back to front, behind what the tile holds already, until nothing can be seen any more. Returns the
// number of fragments: segments that have a length.
std::size_t draw_tile(const ScreenCells& cells, const Shading& shading, const Tile& tile, std::span<const std::uint32_t> items);

// Where a fragment enters and leaves its cell, as far as isosurfaces care.
struct SurfaceEnds {
    std::uint32_t item;
    std::int32_t level_front, level_back;        // of its scalars (PreparedSurfaces)
    float near_front, near_back;                 // whole nearness
    glm::vec3 gradient_front, gradient_back;     // for normals, where both levels differ or the medium is lit
};

// Fragments that wait until no cell can put one in front of them any more. Memory of a thread, kept from tile to tile.
struct PendingFragments {
    std::vector<float> front, back, length, key;
    std::vector<std::int32_t> pixel;
    std::vector<SurfaceEnds> ends;       // with isosurfaces
    std::vector<float> nearest;          // per group of items: no later one is nearer
    std::vector<std::uint32_t> sorted;   // numbers of fragments, pixel by pixel
};

// The same for items in any order, best nearly sorted: the fragments of each pixel are sorted before they are composited. The fewer
// cells stand before nearer ones and the smaller they are, the fewer fragments wait.
std::size_t draw_tile_by_pixels(const ScreenCells& cells, const Shading& shading, const Tile& tile,
                                std::span<const std::uint32_t> items, PendingFragments& pending);

// Isosurfaces alone, all of them opaque, of items in any order: the nearest one of each pixel. Returns as draw_tile.
std::size_t draw_nearest_surfaces(const ScreenCells& cells, const Tile& tile, std::span<const std::uint32_t> items);

// The instruction sets that this build has and this machine can run, best first, by Highway's names ("AVX3", "AVX2", "SSE4" …).
std::vector<std::string> instruction_sets();
// The one that is used.
std::string instruction_set();
// Uses no better one than `name`, one of instruction_sets(), from now on, in the whole process. For tests.
void use_instruction_set(const std::string& name);

}  // namespace cellproj::cpu
