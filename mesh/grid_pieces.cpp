// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/grid_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "mesh/grid_error.hpp"

namespace cellproj {

namespace {

constexpr double slack = 1e-3;  // of the lattice's spacing
constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};
// Where float64 still tells planes a thousandth of a cell apart.
constexpr double most_planes = 1e12;

std::string to_words(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", number);
    return text;
}

std::string at(const std::string& place, const std::string& piece) { return place + ", piece " + piece; }

void require_uniform(const std::array<GridAxis, 3>& axes, const std::string& piece) {
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string axis = piece + ", axis " + axis_names[a];
        const int direction = require_monotonic(axes[a], axis);
        if (!axes[a].spacing) refuse_grid(axis, "one spacing", "a rectilinear axis", "resample the piece, or draw it alone");
        if (direction < 0) refuse_grid(axis, "coordinates that ascend", "coordinates that descend", "turn the axis and its values round");
    }
}

// How many lattice cells a spacing is.
std::int64_t step_of(const GridAxis& axis, double finest, const std::string& piece, const char* name) {
    const double ratio = *axis.spacing / finest, whole = std::round(ratio);
    // Over all cells of the axis the difference adds up.
    if (whole < most_planes && std::abs(ratio - whole) * static_cast<double>(axis.cells()) <= slack * whole) return static_cast<std::int64_t>(whole);
    refuse_grid(piece + ", axis " + name, "a spacing that is a whole multiple of the finest one, " + to_words(finest), to_words(*axis.spacing),
                "check the spacings of the pieces");
}

std::int64_t plane_of(double x, const Lattice& lattice, std::size_t axis, const std::string& piece) {
    const double place = (x - lattice.origin[axis]) / lattice.spacing[axis], whole = std::round(place);
    if (std::abs(whole) < most_planes && std::abs(place - whole) <= slack) return static_cast<std::int64_t>(whole);
    refuse_grid(piece + ", axis " + axis_names[axis], "planes among those of the other pieces",
                to_words(x) + ", which is " + to_words(place - std::floor(place)) + " of the finest cell behind one of them",
                "check origin and spacing of the piece");
}

std::int64_t volume(const LatticeIndex& step) { return step[0] * step[1] * step[2]; }

// Levels from the coarsest on, as their steps.
std::vector<LatticeIndex> levels_of(const Lattice& lattice, std::span<const std::string> names, const std::string& place) {
    std::vector<LatticeIndex> steps;
    for (std::size_t p = 0; p < lattice.pieces.size(); ++p) {
        const LatticeIndex& step = lattice.pieces[p].step;
        if (std::find(steps.begin(), steps.end(), step) != steps.end()) continue;
        for (const LatticeIndex& other : steps)
            for (std::size_t a = 0; a < 3; ++a) {
                const bool coarser = volume(step) >= volume(other);
                const std::int64_t wide = coarser ? step[a] : other[a], narrow = coarser ? other[a] : step[a];
                if (wide % narrow == 0) continue;
                refuse_grid(at(place, names[p]) + ", axis " + axis_names[a], "a spacing that divides, or is a multiple of, those of all other levels",
                            "cells " + std::to_string(step[a]) + " and " + std::to_string(other[a]) + " times as long as the finest",
                            "check the spacings of the pieces");
            }
        steps.push_back(step);
    }
    std::sort(steps.begin(), steps.end(), [](const LatticeIndex& a, const LatticeIndex& b) { return volume(a) > volume(b); });
    return steps;
}

void require_on_level(const PiecePlace& piece, const std::string& name) {
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t off = ((piece.box.low[a] % piece.step[a]) + piece.step[a]) % piece.step[a];
        if (off == 0) continue;
        refuse_grid(name + ", axis " + axis_names[a], "planes where those of its level " + std::to_string(piece.level) + " are",
                    "planes that are moved by " + std::to_string(off) + "/" + std::to_string(piece.step[a]) + " of a cell", "check the origin of the piece");
    }
}

void require_apart(const Lattice& lattice, std::span<const std::string> names, const std::string& place) {
    for (std::size_t p = 0; p < lattice.pieces.size(); ++p)
        for (std::size_t q = p + 1; q < lattice.pieces.size(); ++q) {
            if (lattice.pieces[p].level != lattice.pieces[q].level) continue;
            const LatticeBox both = intersection(lattice.pieces[p].box, lattice.pieces[q].box);
            if (both.is_empty()) continue;
            std::string where;
            for (std::size_t a = 0; a < 3; ++a)
                where += (a == 0 ? "" : ", ") + to_words(lattice.plane(a, both.low[a])) + " .. " + to_words(lattice.plane(a, both.high[a]));
            refuse_grid(at(place, names[q]), "pieces of one level that lie beside each other", "an overlap with piece " + names[p] + " in " + where,
                        "cut one of them");
        }
}

// Marks the piece's cells that `finer` covers, wholly or in part.
void mark(const PiecePlace& piece, const LatticeBox& finer, std::vector<bool>& covered, std::vector<bool>& partly) {
    const LatticeBox both = intersection(piece.box, finer);
    if (both.is_empty()) return;
    LatticeIndex first{}, last{}, cells{};  // cells that are touched
    for (std::size_t a = 0; a < 3; ++a) {
        first[a] = (both.low[a] - piece.box.low[a]) / piece.step[a];
        last[a] = (both.high[a] - piece.box.low[a] + piece.step[a] - 1) / piece.step[a];
        cells[a] = (piece.box.high[a] - piece.box.low[a]) / piece.step[a];
    }
    const auto inside = [&](std::size_t a, std::int64_t i) {
        const std::int64_t low = piece.box.low[a] + i * piece.step[a];
        return low >= both.low[a] && low + piece.step[a] <= both.high[a];
    };
    for (std::int64_t k = first[2]; k < last[2]; ++k)
        for (std::int64_t j = first[1]; j < last[1]; ++j)
            for (std::int64_t i = first[0]; i < last[0]; ++i) {
                const auto id = static_cast<std::size_t>(i + cells[0] * (j + cells[1] * k));
                (inside(0, i) && inside(1, j) && inside(2, k) ? covered : partly)[id] = true;
            }
}

}  // namespace

LatticeBox intersection(const LatticeBox& a, const LatticeBox& b) {
    LatticeBox both;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        both.low[axis] = std::max(a.low[axis], b.low[axis]);
        both.high[axis] = std::min(a.high[axis], b.high[axis]);
    }
    return both;
}

Lattice place_pieces(std::span<const std::array<GridAxis, 3>> axes, std::span<const std::string> names, const std::string& place) {
    if (axes.empty()) refuse_grid(place, "at least one piece", "none", "name the files of the pieces");
    for (std::size_t p = 0; p < axes.size(); ++p) require_uniform(axes[p], at(place, names[p]));
    Lattice lattice;
    lattice.pieces.resize(axes.size());
    for (std::size_t a = 0; a < 3; ++a) {
        double finest = std::numeric_limits<double>::infinity();
        for (const auto& piece : axes) finest = std::min(finest, *piece[a].spacing);
        std::size_t coarsest = 0;
        for (std::size_t p = 0; p < axes.size(); ++p) {
            lattice.pieces[p].step[a] = step_of(axes[p][a], finest, at(place, names[p]), axis_names[a]);
            if (lattice.pieces[p].step[a] > lattice.pieces[coarsest].step[a]) coarsest = p;
        }
        // From the coarsest piece: its decimals are the best, as they are shared by the most lattice cells.
        lattice.origin[a] = axes[coarsest][a].coordinates.front();
        lattice.spacing[a] = *axes[coarsest][a].spacing / static_cast<double>(lattice.pieces[coarsest].step[a]);
        for (std::size_t p = 0; p < axes.size(); ++p) {
            PiecePlace& piece = lattice.pieces[p];
            piece.box.low[a] = plane_of(axes[p][a].coordinates.front(), lattice, a, at(place, names[p]));
            piece.box.high[a] = piece.box.low[a] + piece.step[a] * static_cast<std::int64_t>(axes[p][a].cells());
            // The last plane, too: a spacing that is a little off moves it most.
            if (plane_of(axes[p][a].coordinates.back(), lattice, a, at(place, names[p])) == piece.box.high[a]) continue;
            refuse_grid(at(place, names[p]) + ", axis " + axis_names[a], "planes among those of the other pieces", "an end between them",
                        "check origin and spacing of the piece");
        }
    }
    const std::vector<LatticeIndex> steps = levels_of(lattice, names, place);
    lattice.levels = static_cast<int>(steps.size());
    for (std::size_t p = 0; p < axes.size(); ++p) {
        PiecePlace& piece = lattice.pieces[p];
        piece.level = static_cast<int>(std::find(steps.begin(), steps.end(), piece.step) - steps.begin());
        require_on_level(piece, at(place, names[p]));
    }
    require_apart(lattice, names, place);
    return lattice;
}

std::vector<std::vector<bool>> covered_cells(const Lattice& lattice, std::span<const std::string> names, const std::string& place) {
    std::vector<std::vector<bool>> all;
    for (std::size_t p = 0; p < lattice.pieces.size(); ++p) {
        const PiecePlace& piece = lattice.pieces[p];
        std::size_t cells = 1;
        for (std::size_t a = 0; a < 3; ++a) cells *= static_cast<std::size_t>((piece.box.high[a] - piece.box.low[a]) / piece.step[a]);
        std::vector<bool> covered(cells, false), partly(cells, false);
        for (const PiecePlace& other : lattice.pieces)
            if (other.level > piece.level) mark(piece, other.box, covered, partly);
        // A part is none where a piece of a level between covers the whole.
        for (std::size_t c = 0; c < cells; ++c) {
            if (!partly[c] || covered[c]) continue;
            refuse_grid(at(place, names[p]) + ", cell " + std::to_string(c), "finer pieces that cover cells wholly or not at all",
                        "a finer piece that covers a part of it", "let refined pieces end at planes of the next coarser level");
        }
        all.push_back(std::move(covered));
    }
    return all;
}

}  // namespace cellproj
