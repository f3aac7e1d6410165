// SPDX-License-Identifier: BSD-3-Clause
//
// What cuts rays short, on the command line: clipping planes, a box, opaque bodies from surface files, and slices of the field.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mesh/tet_mesh.hpp"
#include "render/scene.hpp"

namespace CLI {
class App;
}

namespace cellproj::cli {

struct CutOptions {
    std::vector<std::string> planes;    // --clip, each X,Y,Z:NX,NY,NZ
    std::string box;                    // --clip-box X0,Y0,Z0,X1,Y1,Z1; empty: none
    std::vector<std::string> surfaces;  // --surface, each FILE[:COLOR]
    std::vector<std::string> slices;    // --slice, each X,Y,Z:NX,NY,NZ
    bool caps = false;                  // --caps
};

// Into `options`, which must live as long as the command.
void add_cut_options(CLI::App& command, CutOptions& options);

// What all of --clip and --clip-box keep; no half spaces: everything. Throws Error (option).
ClipRegion parse_region(const CutOptions& options);
// The planes of --slice. Throws Error (option).
std::vector<HalfSpace> parse_slices(const CutOptions& options);
// What they will make, without reading a file.
RayCuts planned_cuts(const CutOptions& options);
// A file, or demo:sphere, and its colour; throws Error (option).
struct BodyChoice {
    std::string file;
    glm::dvec3 color;
};
BodyChoice parse_body(const std::string& text);

// Into the scene; reads the surfaces. Slices and caps have the colours of `colors`; `grid`: that which is drawn as it is, or null for the mesh.
// Warns of slices beside the mesh. Throws Error (option) for a region in which nothing of the mesh is, and as `read_surface`.
void add_cuts(const CutOptions& options, const Lighting& lighting, std::shared_ptr<const TransferFunction> colors, const Grid* grid, Scene& scene);

// The options as they were given, for the picture's text; empty for none.
std::string text_of(const CutOptions& options);

}  // namespace cellproj::cli
