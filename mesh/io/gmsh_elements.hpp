// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: Gmsh's element types, and its tags, which may have gaps.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "mesh/dataset.hpp"

namespace cellproj {

struct GmshElementType {
    int nodes = 0;                             // its corners first, in VTK's order
    std::optional<CellKind> kind;              // empty for points, lines and surfaces
    std::span<const std::int8_t> places = {};  // of second order: where the extra nodes stand (curved_cells.hpp)
};

// Empty for an unknown type, for polygons and for polyhedra.
std::optional<GmshElementType> gmsh_element_type(std::int64_t type);

// From tags to the places at which they stood.
class GmshTags {
public:
    GmshTags() = default;
    explicit GmshTags(const std::vector<std::uint64_t>& tags);

    std::optional<std::uint32_t> find(std::uint64_t tag) const;
    bool unique() const { return unique_; }  // no tag stood twice

private:
    std::vector<std::uint32_t> places_;                            // by tag, where the tags have few gaps
    std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_;  // otherwise
    bool unique_ = true;
};

}  // namespace cellproj
