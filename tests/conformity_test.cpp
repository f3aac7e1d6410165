// SPDX-License-Identifier: BSD-3-Clause
//
// Neighbours must cut their common face alike, whatever kinds they are: no face is used more than twice, only the faces
// on the surface of the data are used once, and the tetrahedra fill what the surface encloses.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <ostream>
#include <random>
#include <span>
#include <string>

#include <glm/geometric.hpp>

#include "mesh/cell_faces.hpp"
#include "mesh/cell_split.hpp"
#include "mesh/dataset.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace conformity_test {

using testing_support::total_volume;

// The divergence theorem for the field x/3, seen from the middle of the mesh to keep the terms small.
double volume_inside_boundary(const TetMesh& mesh, const Adjacency& adjacency) {
    const glm::dvec3 origin = bounds(mesh.points).center();
    double sum = 0.0;
    for (const auto& [cell, face] : boundary_faces(adjacency)) {
        const auto v = face_vertices(mesh.tets[cell], face);
        const glm::dvec3 a = mesh.points[v[0]] - origin;
        sum += glm::dot(a, glm::cross(mesh.points[v[1]] - origin, mesh.points[v[2]] - origin)) / 6.0;
    }
    return sum;
}

std::span<const VertexId> cell_of(const CellList& cells, std::size_t c) {
    return std::span(cells.vertices).subspan(cells.offsets[c], cells.offsets[c + 1] - cells.offsets[c]);
}

// From the cells' own faces: a face of n vertices that only one cell has must become n - 2 triangles.
std::size_t expected_boundary_triangles(const CellList& cells) {
    std::vector<VertexId> vertices;      // of all faces, each ascending
    std::vector<std::size_t> starts{0};  // of each face
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for_each_face(cells.kinds[c], cell_of(cells, c), [&](std::span<const VertexId> face) {
            vertices.insert(vertices.end(), face.begin(), face.end());
            std::sort(vertices.begin() + static_cast<std::ptrdiff_t>(starts.back()), vertices.end());
            starts.push_back(vertices.size());
        });
    }
    const auto face = [&](std::size_t f) { return std::span(vertices).subspan(starts[f], starts[f + 1] - starts[f]); };
    const auto less = [&](std::size_t f, std::size_t g) {
        return std::lexicographical_compare(face(f).begin(), face(f).end(), face(g).begin(), face(g).end());
    };
    std::vector<std::size_t> order(starts.size() - 1);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), less);
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool like_before = i > 0 && !less(order[i - 1], order[i]);
        const bool like_next = i + 1 < order.size() && !less(order[i], order[i + 1]);
        if (!like_before && !like_next) triangles += face(order[i]).size() - 2;
    }
    return triangles;
}

// Two triangles per quadrangle on the six sides of a grid.
std::size_t expected_boundary_triangles(const GridDimensions& grid) {
    const std::size_t i = grid.ni - 1, j = grid.nj - 1, k = grid.nk - 1;
    return 4 * (i * j + j * k + k * i);
}

// Sums of up to a million terms of one sign: at most 1e6 · 2^-53 relative, and far less as roundings cancel.
constexpr double volume_tolerance = 1e-9;

// ---- Random blocks of all kinds ----

using Polygon = std::vector<std::array<std::size_t, 2>>;  // grid points (i, j), counter-clockwise

// Two unit squares side by side, cut in one of five ways.
std::vector<Polygon> tile(std::size_t i, std::size_t j, std::size_t way) {
    const Polygon left{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}};
    const Polygon right{{i + 1, j}, {i + 2, j}, {i + 2, j + 1}, {i + 1, j + 1}};
    const Polygon lower_right{{i + 1, j}, {i + 2, j}, {i + 2, j + 1}};
    const Polygon upper_right{{i + 1, j}, {i + 2, j + 1}, {i + 1, j + 1}};
    switch (way) {
        case 0:
            return {left, right};
        case 1:
            return {left, lower_right, upper_right};
        case 2:
            return {{{i, j}, {i + 1, j}, {i + 2, j + 1}, {i + 1, j + 1}, {i, j + 1}}, lower_right};
        default:
            return {{{i, j}, {i + 1, j}, {i + 2, j}, {i + 2, j + 1}, {i + 1, j + 1}, {i, j + 1}}};
    }
}

class MixedBlock {
public:
    MixedBlock(std::array<std::size_t, 3> size, double jitter, std::uint64_t seed) : size_(size), random_(seed) {
        dataset_.source = "block";
        dataset_.cells.offsets = {0};
        make_points(jitter);
        for (std::size_t i = 0; i < size_[0]; i += 2) {
            for (std::size_t j = 0; j < size_[1]; ++j) {
                for (const Polygon& polygon : tile(i, j, random_() % 5)) {
                    for (std::size_t k = 0; k < size_[2]; ++k)
                        add_prism(polygon, k);
                }
            }
        }
        shuffle_ids();
    }

    Dataset take() { return std::move(dataset_); }

private:
    // Moved at random, but not off the surface of the box.
    void make_points(double jitter) {
        std::uniform_real_distribution<double> moved(-jitter, jitter);
        for (std::size_t k = 0; k <= size_[2]; ++k) {
            for (std::size_t j = 0; j <= size_[1]; ++j) {
                for (std::size_t i = 0; i <= size_[0]; ++i) {
                    const std::array<std::size_t, 3> at{i, j, k};
                    glm::dvec3 p(i, j, k);
                    for (int axis = 0; axis < 3; ++axis) {
                        const auto a = static_cast<std::size_t>(axis);
                        if (at[a] != 0 && at[a] != size_[a]) p[axis] += moved(random_);
                    }
                    dataset_.points.push_back(p);
                }
            }
        }
    }

    void add_prism(const Polygon& polygon, std::size_t k) {
        std::vector<VertexId> cell;
        for (const std::size_t layer : {k, k + 1}) {
            for (const auto& [i, j] : polygon)
                cell.push_back(static_cast<VertexId>(i + (size_[0] + 1) * (j + (size_[1] + 1) * layer)));
        }
        const std::size_t n = polygon.size();
        if (random_() % 3 == 0) std::rotate(cell.begin(), cell.begin() + static_cast<std::ptrdiff_t>(n), cell.end());
        constexpr std::array<CellKind, 4> kinds{CellKind::wedge, CellKind::hexahedron, CellKind::pentagonal_prism,
                                                CellKind::hexagonal_prism};
        const CellKind kind = kinds[n - 3];
        switch (random_() % 4) {
            case 0:
                return add_polyhedron(kind, cell);
            case 1:
                return n <= 4 ? add_pyramids(kind, cell) : add(kind, cell);
            default:
                return add(kind, cell);
        }
    }

    void add(CellKind kind, const std::vector<VertexId>& list) {
        dataset_.cells.kinds.push_back(kind);
        dataset_.cells.vertices.insert(dataset_.cells.vertices.end(), list.begin(), list.end());
        dataset_.cells.offsets.push_back(dataset_.cells.vertices.size());
    }

    // Faces in any order of vertices that keeps the cycle, each turned at random.
    void add_polyhedron(CellKind kind, const std::vector<VertexId>& cell) {
        std::vector<VertexId> stream{0};
        for_each_face(kind, cell, [&](std::span<const VertexId> face) {
            std::vector<VertexId> turned(face.begin(), face.end());
            std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(random_() % face.size()),
                        turned.end());
            if (random_() % 2 == 0) std::reverse(turned.begin(), turned.end());
            ++stream[0];
            stream.push_back(static_cast<VertexId>(turned.size()));
            stream.insert(stream.end(), turned.begin(), turned.end());
        });
        add(CellKind::polyhedron, stream);
    }

    // A point in the middle, joined to the faces.
    void add_pyramids(CellKind kind, const std::vector<VertexId>& cell) {
        const auto middle = static_cast<VertexId>(dataset_.points.size());
        glm::dvec3 sum(0.0);
        for (const VertexId v : cell)
            sum += dataset_.points[v];
        dataset_.points.push_back(sum / static_cast<double>(cell.size()));
        for_each_face(kind, cell, [&](std::span<const VertexId> face) {
            std::vector<VertexId> part(face.begin(), face.end());
            part.push_back(middle);
            add(face.size() == 3 ? CellKind::tetrahedron : CellKind::pyramid, part);
        });
    }

    void shuffle_ids() {
        std::vector<VertexId> new_id(dataset_.points.size());
        std::iota(new_id.begin(), new_id.end(), 0U);
        std::shuffle(new_id.begin(), new_id.end(), random_);
        std::vector<glm::dvec3> points(new_id.size());
        for (std::size_t p = 0; p < new_id.size(); ++p)
            points[new_id[p]] = dataset_.points[p];
        dataset_.points = std::move(points);
        for (std::size_t c = 0; c < dataset_.cells.size(); ++c)
            rename(c, new_id);
    }

    void rename(std::size_t c, const std::vector<VertexId>& new_id) {
        CellList& cells = dataset_.cells;
        const bool stream = cells.kinds[c] == CellKind::polyhedron;
        std::uint64_t next_count = stream ? cells.offsets[c] + 1 : cells.offsets[c + 1];
        for (std::uint64_t at = cells.offsets[c] + (stream ? 1 : 0); at < cells.offsets[c + 1]; ++at) {
            if (at == next_count) {
                next_count += 1 + cells.vertices[at];
            } else {
                cells.vertices[at] = new_id[cells.vertices[at]];
            }
        }
    }

    std::array<std::size_t, 3> size_;
    std::mt19937_64 random_;
    Dataset dataset_;
};

void expect_conformal(const Dataset& dataset, const TetMesh& mesh) {
    const Adjacency adjacency = build_adjacency(mesh);
    EXPECT_EQ(adjacency.overused_faces, 0U);
    EXPECT_EQ(boundary_faces(adjacency).size(),
              dataset.grid ? expected_boundary_triangles(*dataset.grid) : expected_boundary_triangles(dataset.cells));
}

void expect_filled(const TetMesh& mesh) {
    const double volume = total_volume(mesh);
    EXPECT_NEAR(volume_inside_boundary(mesh, build_adjacency(mesh)), volume, volume_tolerance * volume);
}

// The split before inverted tetrahedra are turned: each cell's tetrahedra as a whole have its sign. Volumes with signs
// add up to what the boundary encloses even where cells are dented.
TetMesh unturned(const Dataset& dataset) {
    TetMesh mesh{dataset.points, {}, {}, {}};
    CellSplitter splitter(dataset.points);
    for (std::size_t c = 0; c < dataset.cells.size(); ++c) {
        const std::size_t begin = mesh.tets.size();
        const auto centre_id = static_cast<VertexId>(mesh.points.size());
        const CellCentre* centre =
            splitter.split(dataset.cells.kinds[c], cell_of(dataset.cells, c), centre_id, mesh.tets);
        if (centre) mesh.points.push_back(centre->position);
        double volume = 0.0;
        for (std::size_t t = begin; t < mesh.tets.size(); ++t)
            volume += signed_volume(mesh, static_cast<CellId>(t));
        for (std::size_t t = begin; volume < 0.0 && t < mesh.tets.size(); ++t)
            std::swap(mesh.tets[t][2], mesh.tets[t][3]);
    }
    return mesh;
}

TEST(Conformity, OfBlocksOfAllKinds) {
    std::map<CellKind, int> seen;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const Dataset dataset = MixedBlock({6, 5, 4}, seed % 2 == 0 ? 0.0 : 0.1, seed).take();
        for (const CellKind kind : dataset.cells.kinds)
            ++seen[kind];
        TetrahedralizeReport report;
        const TetMesh mesh = tetrahedralize(dataset, &report);
        expect_conformal(dataset, mesh);
        EXPECT_EQ(report.inverted, 0U);
        EXPECT_NEAR(total_volume(mesh), 120.0, 120.0 * volume_tolerance);
        expect_filled(mesh);
    }
    EXPECT_EQ(seen.size(), 7U);  // every kind has taken part
}

// ---- Real files ----

struct RealFile {
    const char* name;
    double volume = 0.0;            // of its cells, 0: not known
    double volume_tolerance = 0.0;  // relative
    std::size_t inverted = 0;       // tetrahedra of cells that are not star-shaped
};

void PrintTo(const RealFile& file, std::ostream* out) { *out << file.name; }

class ConformityOf : public testing::TestWithParam<RealFile> {};

TEST_P(ConformityOf, RealMesh) {
    const std::filesystem::path file = std::filesystem::path(CELLPROJ_SHARED_DATA) / GetParam().name;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "needs " << file;
    const Dataset dataset = read(file);
    if (CELLPROJ_SANITIZED && dataset.points.size() > 15000) GTEST_SKIP() << "too large for unoptimized maps of faces";
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset, &report);
    expect_conformal(dataset, mesh);
    EXPECT_EQ(report.inverted, GetParam().inverted);
    expect_filled(report.inverted == 0 ? mesh : unturned(dataset));
    if (GetParam().volume > 0.0) {
        EXPECT_NEAR(total_volume(mesh), GetParam().volume, GetParam().volume_tolerance * GetParam().volume);
    }
}

std::string name_of(const testing::TestParamInfo<RealFile>& test) {
    std::string name = test.param.name;
    std::replace_if(name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    return name;
}

// Volumes of SOURCES.md, as sums over the kinds where it gives them, to six digits. What lies inside a curved face depends
// on its cut, most in mixing_elbow, whose outer faces are curved and whose cells are all polyhedra: hence the larger
// tolerances. The tetrahedra of the crushed can are counted as they overlap: some of its cells are dented beyond what any
// point in them can see.
INSTANTIATE_TEST_SUITE_P(
    Files, ConformityOf,
    testing::Values(RealFile{"rotordisk_openfoam/rotorDisk_internal.vtu"},
                    RealFile{"mixing_elbow_fluent/mixing_elbow_polyhedra.vtu", 2.50066e-3, 2e-4},
                    RealFile{"flange_openfoam/flange_internal_legacy_ascii.vtk", 1.53249e-05 + 2.96933e-07, 1e-3},
                    RealFile{"flange_openfoam/ensight/flange.case", 1.53249e-05 + 2.96933e-07, 1e-3},
                    RealFile{"can_hex/can.vtu", 48.2139, 0.01, 48},
                    RealFile{"aneurysm_tets_openfoam/aneurysm_tets_internal.vtu", 9.50339e-06, 1e-5},
                    RealFile{"bluntfin/bluntfinxyz.bin"}, RealFile{"brick_su2/mesh_brick_pyra_ffd.su2", 2.0, 1e-5},
                    RealFile{"classic_small/hexa.vtk", 0.875155, 1e-5}, RealFile{"classic_small/polyhedron2pieces.vtu"},
                    RealFile{"classic_small/tetraMesh.vtk"}, RealFile{"classic_small/uGridEx.vtk", 2.0 + 1.0 / 3.0, 1e-9},
                    RealFile{"combustor/combxyz.bin"}, RealFile{"cylinder3d_cgns/cylinder3D_hdf5.cgns", 0.246113, 1e-5},
                    RealFile{"disk_out_exodus/disk_out_ref.ex2", 1629.67, 1e-3}, RealFile{"ensight_nfaced/TEST.case"},
                    RealFile{"ensight_nfaced/TEST_bin.case"},
                    RealFile{"exodus_small/simple-cube-multi-element-order1.e", 4.0, 1e-5},
                    RealFile{"fire_hex/fire_ug.vtu", 35.5475, 1e-5}, RealFile{"gmsh/indheat.bin.v41.msh", 1.0, 1e-5},
                    RealFile{"gmsh/piece.asc.v22.msh"}, RealFile{"kitchen/kitchen.vtk"}, RealFile{"medit/bunny.mesh"},
                    RealFile{"medit/torus.mesh"}, RealFile{"office/office.binary.vtk"},
                    RealFile{"openfoam_case/64BitFloats/case.foam", 8.0, 1e-9},
                    RealFile{"openfoam_case/cavity/case.foam", 1e-4, 1e-5},
                    RealFile{"pipe_quadratic/CylinderQuadratic.vtk"},
                    RealFile{"pipe_quadratic/CylinderLinear.vtk", 3.05608e-05, 1e-5},
                    RealFile{"post_tets/post.vtk", 27.7949, 1e-5}, RealFile{"seamount/seamount.vtu", 82.3724, 1e-5},
                    RealFile{"tetgen/example.1.node"}, RealFile{"volumes/RectGrid2.vtk"},
                    RealFile{"volumes/nrrd/BallBinary30x30x30.nhdr", 29.0 * 29.0 * 29.0, 1e-9}),
    name_of);

}  // namespace
}  // namespace cellproj
