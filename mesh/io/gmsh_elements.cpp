// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/gmsh_elements.hpp"

#include <algorithm>
#include <array>

namespace cellproj {

namespace {

constexpr std::uint32_t nowhere = 0xffffffffU;

// Gmsh reference manual, "Node ordering": edges by their lower, then their higher corner, but for the last two of the
// tetrahedron; faces likewise.
constexpr std::array<std::int8_t, 6> tet_places{4, 5, 6, 7, 9, 8};
constexpr std::array<std::int8_t, 19> hex_20_places{8,  11, 13, 9,  16, 18, 19, 17, 10, 12,
                                                    14, 15, -1, -1, -1, -1, -1, -1, -1};
constexpr std::array<std::int8_t, 19> hex_27_places{8,  11, 13, 9,  16, 18, 19, 17, 10, 12,
                                                    14, 15, 20, 25, 21, 23, 24, 22, 26};
constexpr std::array<std::int8_t, 12> wedge_15_places{6, 9, 7, 12, 14, 13, 8, 10, 11, -1, -1, -1};
constexpr std::array<std::int8_t, 12> wedge_18_places{6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16};
constexpr std::array<std::int8_t, 9> pyramid_13_places{5, 8, 10, 6, 7, 9, 11, 12, -1};
constexpr std::array<std::int8_t, 9> pyramid_14_places{5, 8, 10, 6, 7, 9, 11, 12, 13};

}  // namespace

// Gmsh reference manual, "MSH file format"; the third- and fourth-order quadrilaterals and prisms: its GmshDefines.h.
std::optional<GmshElementType> gmsh_element_type(std::int64_t type) {
    const auto flat = [](int nodes) { return GmshElementType{nodes, std::nullopt, {}}; };
    const auto volume = [](int nodes, CellKind kind, std::span<const std::int8_t> places = {}) {
        return GmshElementType{nodes, kind, places};
    };
    switch (type) {
        case 1:
            return flat(2);
        case 2:
            return flat(3);
        case 3:
            return flat(4);
        case 4:
            return volume(4, CellKind::tetrahedron);
        case 5:
            return volume(8, CellKind::hexahedron);
        case 6:
            return volume(6, CellKind::wedge);
        case 7:
            return volume(5, CellKind::pyramid);
        case 8:
            return flat(3);
        case 9:
            return flat(6);
        case 10:
            return flat(9);
        case 11:
            return volume(10, CellKind::tetrahedron, tet_places);
        case 12:
            return volume(27, CellKind::hexahedron, hex_27_places);
        case 13:
            return volume(18, CellKind::wedge, wedge_18_places);
        case 14:
            return volume(14, CellKind::pyramid, pyramid_14_places);
        case 15:
            return flat(1);
        case 16:
            return flat(8);
        case 17:
            return volume(20, CellKind::hexahedron, hex_20_places);
        case 18:
            return volume(15, CellKind::wedge, wedge_15_places);
        case 19:
            return volume(13, CellKind::pyramid, pyramid_13_places);
        case 20:
            return flat(9);
        case 21:
            return flat(10);
        case 22:
            return flat(12);
        case 23:
            return flat(15);
        case 24:
            return flat(15);
        case 25:
            return flat(21);
        case 26:
            return flat(4);
        case 27:
            return flat(5);
        case 28:
            return flat(6);
        case 29:
            return volume(20, CellKind::tetrahedron);
        case 30:
            return volume(35, CellKind::tetrahedron);
        case 31:
            return volume(56, CellKind::tetrahedron);
        case 36:
            return flat(16);
        case 37:
            return flat(25);
        case 90:
            return volume(40, CellKind::wedge);
        case 91:
            return volume(75, CellKind::wedge);
        case 92:
            return volume(64, CellKind::hexahedron);
        case 93:
            return volume(125, CellKind::hexahedron);
        default:
            return std::nullopt;
    }
}

GmshTags::GmshTags(const std::vector<std::uint64_t>& tags) {
    const std::uint64_t largest = tags.empty() ? 0 : *std::max_element(tags.begin(), tags.end());
    if (largest <= 4 * tags.size() + 1024) {
        places_.assign(largest + 1, nowhere);
        for (std::size_t i = 0; i < tags.size(); ++i) {
            std::uint32_t& place = places_[tags[i]];
            unique_ = unique_ && place == nowhere;
            place = static_cast<std::uint32_t>(i);
        }
        return;
    }
    sorted_.reserve(tags.size());
    for (std::size_t i = 0; i < tags.size(); ++i)
        sorted_.emplace_back(tags[i], static_cast<std::uint32_t>(i));
    std::sort(sorted_.begin(), sorted_.end());
    const auto same_tag = [](const auto& a, const auto& b) { return a.first == b.first; };
    unique_ = std::adjacent_find(sorted_.begin(), sorted_.end(), same_tag) == sorted_.end();
}

std::optional<std::uint32_t> GmshTags::find(std::uint64_t tag) const {
    if (!places_.empty()) {
        if (tag >= places_.size() || places_[tag] == nowhere) return std::nullopt;
        return places_[tag];
    }
    const auto found = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair(tag, std::uint32_t{0}));
    if (found == sorted_.end() || found->first != tag) return std::nullopt;
    return found->second;
}

}  // namespace cellproj
