// SPDX-License-Identifier: BSD-3-Clause
//
// The relations of SXMPVO (Cook, Max, Silva, Williams, "Image-Space Visibility Ordering for Cell Projection Volume Rendering of
// Unstructured Data", IEEE TVCG 10(6), 2004): boundary faces are scan-converted into a list per pixel; where the ray of a pixel
// leaves one cell and enters the next across the outside, the first of the two (seen from the back) is behind.
//
// With the relations of face neighbours these are all relations between consecutive cells on the rays through pixel centres: an
// order that keeps them is exact there, for any mesh whose cells do not overlap. No preparation but the list of boundary faces.
//
// Robust: which pixel centres a face covers and which of two faces is nearer are decided in float64 where its error bound allows,
// else exactly. A ray through a vertex, an edge or in a face is decided as if moved by (ε, ε²) pixels, the same for all faces, so
// that it enters and leaves in turn (Edelsbrunner and Mücke, ACM TOG 9(1), 1990). Where two faces coincide, as do pieces in contact
// whose points were never merged, leaving comes before entering; also where they reach into each other by rounding, up to a millionth
// of their edges.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sort/view_order.hpp"

namespace cellproj {

struct BoundaryScan {
    std::vector<OrderArc> arcs;    // each once, ascending by (behind, front)
    std::size_t crossed_rays = 0;  // pixels whose ray does not enter and leave in turn: cells overlap there
};

// `boundary`: order_boundary(graph). Inverted cells count as what they cover. In perspective, what lies behind the eye is not seen.
// The same for any number of threads.
BoundaryScan scan_boundary(const TetMesh& mesh, std::span<const BoundaryFace> boundary, const PixelGrid& pixels);

}  // namespace cellproj
