// SPDX-License-Identifier: BSD-3-Clause
//
// What a picture cost: times per stage and counts, with the stable JSON keys that others read.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/plan_rules.hpp"

namespace cellproj {

// Milliseconds since construction.
class Stopwatch {
public:
    double ms() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// An order against the sequence of cells along the rays of some pixels (render/order_check.hpp).
struct OrderCheck {
    std::size_t rays = 0;
    std::size_t wrong_rays = 0;  // with at least one wrong pair
    std::size_t wrong_pairs = 0;  // cells that follow each other along a ray, but not in the order
};

// One picture. Stages overlap (projection feeds the drawing), so `total` is less than their sum can be; it is the frame from camera to
// pixels in memory.
struct Statistics {
    struct {
        double plan = 0, sort = 0, project = 0, draw = 0, read_back = 0, total = 0, write = 0;
    } ms;
    struct {
        std::size_t cells = 0;      // in the mesh
        std::size_t culled = 0;     // not drawn: invisible, outside the view, between pixel centres, values not finite
        std::size_t drawn = 0;
        std::size_t triangles = 0;  // OpenGL
        std::size_t fragments = 0;  // CPU backend: segments that were composited
        std::size_t unordered = 0;  // cells that the sorter could only order by depth
        std::size_t cycles = 0;            // visibility cycles
        std::size_t split_cells = 0;       // cells drawn as pieces, to get out of them
        std::optional<std::size_t> order_violations = 0;  // pairs of face neighbours drawn the wrong way round; nothing: not counted
    } counts;
    std::string drawn_as = "tetrahedra";  // or "grid": the boxes of a regular grid as they are
    std::string method;           // of integration: "preint3d:64"
    std::string target;           // format of the framebuffer: "rgba32f"
    std::size_t table_bytes = 0;  // memory of its tables
    std::string backend;          // "gl_osmesa", "gl_egl", "cpu"
    std::string backend_version;  // what the driver says of itself; the instruction set and the threads
    std::string order;            // method of sorting: "mpvo"; "pixel", "none": cells needed no order
    bool order_exact = false;     // proven for this mesh and view
    std::vector<Decision> plan;   // what the scene required (render/plan.hpp)
    std::optional<OrderCheck> order_check;  // when it was asked for
    std::optional<double> error;  // measured error, when it was measured
};

struct RunStatistics {
    struct {
        double read = 0, tetrahedralize = 0, prepare = 0;
    } once_ms;
    std::vector<Statistics> pictures;
    std::size_t peak_memory_bytes = 0;
};

// The middle one of an odd number of values, the upper of the middle two of an even one. At least one value.
double median(std::vector<double> values);

// Largest resident set of this process so far [bytes]; 0 where /proc does not tell.
std::size_t peak_memory_bytes();

// The JSON of the design; what was not measured is null.
std::string to_json(const RunStatistics& run);

}  // namespace cellproj
