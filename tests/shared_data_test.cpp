// SPDX-License-Identifier: BSD-3-Clause
//
// Every file of ../shared/data, against what its SOURCES.md says: one row for each that can be read, a reason for each
// that is a part of another or no input. A file that is in neither list fails the test.
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <ostream>
#include <set>

#include <gtest/gtest.h>

#include "mesh/scalar_field.hpp"
#include "mesh/surface.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace shared_data_test {

// ---- Volumes ----

struct CellCounts {
    std::size_t tetrahedra = 0, hexahedra = 0, wedges = 0, pyramids = 0, polyhedra = 0;

    bool operator==(const CellCounts&) const = default;
};

std::ostream& operator<<(std::ostream& stream, const CellCounts& n) {
    return stream << n.tetrahedra << " tetrahedra, " << n.hexahedra << " hexahedra, " << n.wedges << " wedges, "
                  << n.pyramids << " pyramids, " << n.polyhedra << " polyhedra";
}

CellCounts count_cells(const Dataset& dataset) {
    CellCounts n;
    if (dataset.grid) n.hexahedra = dataset.grid->cells();
    for (const CellKind kind : dataset.cells.kinds) {
        n.tetrahedra += kind == CellKind::tetrahedron ? 1 : 0;
        n.hexahedra += kind == CellKind::hexahedron ? 1 : 0;
        n.wedges += kind == CellKind::wedge ? 1 : 0;
        n.pyramids += kind == CellKind::pyramid ? 1 : 0;
        n.polyhedra += kind == CellKind::polyhedron ? 1 : 0;
    }
    return n;
}

struct Row {
    const char* file;
    const char* format;
    std::size_t points;
    CellCounts cells;
    const char* field = "";    // point fields first; "": the file has none at all
    double low = 0, high = 0;  // of its magnitude
    double volume = 0;         // 0: SOURCES.md does not say
    std::size_t skipped_blocks = 0;
    ReadOptions options = {};
    double volume_tolerance = 1e-5;  // relative; SOURCES.md gives six digits
};

void PrintTo(const Row& row, std::ostream* stream) {
    *stream << row.file;
}

const std::string data = CELLPROJ_SHARED_DATA;

std::vector<Row> rows() {
    constexpr const char* vtu = "VTK XML unstructured grid";
    constexpr const char* vtk = "VTK legacy unstructured grid";
    const RawVolume head{.dimensions = {48, 62, 42}, .spacing = glm::dvec3(4.0)};
    const RawVolume ball{.dimensions = {30, 30, 30}, .type = NumberType::int16};
    // clang-format off
    return {
        {"bluntfin/bluntfinxyz.bin", "PLOT3D curvilinear grid", 40960, {.hexahedra = 37479}, "Mach", 0, 3.38545,
         931.1626963980399, 0, {.solution = data + "/bluntfin/bluntfinq.bin"}},
        {"combustor/combxyz.bin", "PLOT3D curvilinear grid", 47025, {.hexahedra = 43008}, "Density", 0.197813,
         0.710419, 1061.6972944875254, 0, {.solution = data + "/combustor/combq.bin"}},
        {"post_tets/post.vtk", vtk, 2288, {.tetrahedra = 8750}, "Pressure", 0.355368, 1.64124, 27.7949},
        {"seamount/seamount.vtu", vtu, 20004, {.tetrahedra = 100450}, "Velocity", 0.00455783, 1.27143, 82.3724},
        {"rotordisk_openfoam/rotorDisk_internal.vtu", vtu, 86271, {.hexahedra = 60193, .wedges = 5280,
         .polyhedra = 6170}, "U", 0.00776354, 1.55779},
        {"aneurysm_tets_openfoam/aneurysm_tets_internal.vtu", vtu, 22130, {.tetrahedra = 101354}, "p", -0.0572108,
         0.293604, 9.50339e-06},
        {"aneurysm_tets_openfoam/aneurysm_tets_lz4_appended_raw.vtu", vtu, 22130, {.tetrahedra = 101354}, "U", 0,
         0.53478, 9.50339e-06},
        // SOURCES.md splits hexahedra in another way (1.562183e-5 in all). Not all faces are planar: fanned around
        // their lowest point, as here, the divergence theorem over the cells' faces gives 1.5622994e-5; around their
        // mean, 1.5623050e-5.
        {"flange_openfoam/flange_internal_legacy_ascii.vtk", vtk, 7189, {.hexahedra = 5340, .wedges = 372}, "T", 273,
         573, 1.5622994e-05},
        {"flange_openfoam/ensight/flange.case", "EnSight Gold", 7189, {.hexahedra = 5340, .wedges = 372}, "T", 274.313,
         572.982, 1.5622994e-05, 4},
        {"brick_su2/mesh_brick_pyra_ffd.su2", "SU2 mesh", 14030, {.tetrahedra = 71884, .pyramids = 741}},
        {"cylinder3d_cgns/cylinder3D_adf.cgns", "CGNS", 5696, {.tetrahedra = 27591}, "", 0, 0, 0.246113},
        {"cylinder3d_cgns/cylinder3D_hdf5.cgns", "CGNS", 5696, {.tetrahedra = 27591}, "", 0, 0, 0.246113},
        {"disk_out_exodus/disk_out_ref.ex2", "Exodus II", 8499, {.hexahedra = 7472}, "V", 0, 22.4188, 1629.67},
        {"exodus_small/simple-cube-multi-element-order1.e", "Exodus II", 719, {.tetrahedra = 295, .hexahedra = 27,
         .wedges = 250, .pyramids = 750}, "", 0, 0, 4},
        {"fire_hex/fire_ug.vtu", vtu, 12323, {.hexahedra = 10462}, "uvw", 0.0099482, 3.82231, 35.5475},
        // Crushed: its faces are so far from planar that the ways to fill them in give 47.84 (fanned around the lowest
        // point) to 48.21 (SOURCES.md).
        {"can_hex/can.vtu", vtu, 6724, {.hexahedra = 4800}, "EQPS", 0.0215831, 2.89394, 48.02, 0, {}, 0.004},
        // By the corners first, as SOURCES.md measures it.
        {"pipe_quadratic/CylinderQuadratic.vtk", vtk, 2814, {.tetrahedra = 1522}, "pressure", -98.4392, 7234.49,
         3.05608e-05, 0, {.subdivide = 0}},
        {"pipe_quadratic/CylinderQuadratic.vtk", vtk, 2814, {.tetrahedra = 8 * 1522}, "pressure", -98.4392, 7234.49},
        {"pipe_quadratic/CylinderLinear.vtk", vtk, 465, {.tetrahedra = 1522}, "velocity", 0, 1.0044, 3.05608e-05},
        {"office/office.binary.vtk", "VTK legacy structured grid", 8400, {.hexahedra = 7220}, "vectors", 0, 0.804935},
        {"classic_small/hexa.vtk", vtk, 12167, {.hexahedra = 10648}, "scalars", 0.753065, 17.3205, 0.875155},
        {"classic_small/uGridEx.vtk", vtk, 27, {.tetrahedra = 2, .hexahedra = 2}, "vectors", 1, 2, 2 + 0.333333},
        {"classic_small/tetraMesh.vtk", vtk, 55, {.tetrahedra = 160}, "scalars", 0, 4},
        {"classic_small/polyhedron2pieces.vtu", vtu, 18, {.pyramids = 2, .polyhedra = 2}},
        {"ensight_nfaced/TEST.case", "EnSight Gold", 350, {.hexahedra = 122, .polyhedra = 18}, "Velocity", 0.00721482,
         0.0365523, 0, 1},
        {"ensight_nfaced/TEST_bin.case", "EnSight Gold", 350, {.hexahedra = 122, .polyhedra = 18}, "Velocity",
         0.00721482, 0.0365522, 0, 1},
        {"openfoam_case/cavity/case.foam", "OpenFOAM case", 882, {.hexahedra = 400}, "p", 0, 0, 0, 0, {.time = 0.0}},
        {"openfoam_case/64BitFloats/case.foam", "OpenFOAM case", 12, {.hexahedra = 2}, "U", 1, 2},
        // The ranges of these and of TetGen's are those of the columns in their files.
        {"gmsh/piece.asc.v22.msh", "Gmsh MSH 2, ascii", 3939, {.tetrahedra = 13179}, "entity", 1, 4},
        {"gmsh/indheat.bin.v41.msh", "Gmsh MSH 4.1, binary", 5291, {.tetrahedra = 30444}, "physical", 1000, 1002},
        {"medit/bunny.mesh", "Medit mesh", 5433, {.tetrahedra = 34055}, "region", 0, 0},
        {"medit/torus.mesh", "Medit mesh", 4351, {.tetrahedra = 20067}, "solution_2", 32.5073, 107414},
        {"tetgen/example.1.node", "TetGen nodes and tetrahedra", 482, {.tetrahedra = 1533}, "boundary_marker", 0, 9},
        {"tetgen/example.1.ele", "TetGen nodes and tetrahedra", 482, {.tetrahedra = 1533}, "boundary_marker", 0, 9},
        {"volumes/hydrogen.vti", "VTK XML image", 262144, {.hexahedra = 250047}, "probability_density", 0, 1},
        {"volumes/HeadMRVolume.mhd", "MetaImage", 124992, {.hexahedra = 117547}, "MetaImage", 0, 255},
        {"volumes/HeadMRVolume.raw", "raw volume", 124992, {.hexahedra = 117547}, "value", 0, 255, 0, 0, {.raw = head}},
        {"volumes/neghip.slc", "SLC", 287496, {.hexahedra = 274625}, "SLCImage", 0, 255},
        {"volumes/RectGrid2.vtk", "VTK legacy rectilinear grid", 17061, {.hexahedra = 14720}, "vectors", 0, 10.3964},
        {"volumes/nrrd/BallBinary30x30x30.nrrd", "NRRD", 27000, {.hexahedra = 24389}, "ImageFile", 0, 257},
        {"volumes/nrrd/BallBinary30x30x30.nhdr", "NRRD", 27000, {.hexahedra = 24389}, "ImageFile", 0, 257},
        {"volumes/nrrd/BallBinary30x30x30_gz.nrrd", "NRRD", 27000, {.hexahedra = 24389}, "ImageScalars", 0, 257},
        {"volumes/nrrd/BallBinary30x30x30.raw", "raw volume", 27000, {.hexahedra = 24389}, "value", 0, 257, 0, 0,
         {.raw = ball}},
        // SOURCES.md says 2.50066e-3, and both are right: four of five faces are not planar, so a cell's volume depends
        // on how its faces are filled in. Between cells that cancels; on the 4799 faces of the boundary it does not. By
        // the divergence theorem over these, faces fanned around their mean give 2.500655e-3, faces fanned around their
        // lowest point, as they are cut here, 2.500306e-3.
        {"mixing_elbow_fluent/mixing_elbow_polyhedra.vtu", vtu, 61651, {.polyhedra = 17822}, "pressure", -0.34599,
         1.14612, 2.500306e-3},
        {"kitchen/kitchen.vtk", "VTK legacy structured grid", 11424, {.hexahedra = 9936}, "velocity", 0, 0.452266}};
    // clang-format on
}

class SharedDataVolume : public testing::TestWithParam<Row> {};

double volume_of(const Dataset& dataset) {
    const TetMesh mesh = tetrahedralize(dataset);
    double sum = 0;
    for (CellId t = 0; t < mesh.tets.size(); ++t)
        sum += signed_volume(mesh, t);
    return sum;
}

TEST_P(SharedDataVolume, IsAsSourcesSay) {
    const Row& row = GetParam();
    const fs::path file = fs::path(data) / row.file;
    if (!fs::exists(file)) GTEST_SKIP() << "needs " << file;
    const Dataset dataset = read(file, row.options);
    EXPECT_EQ(dataset.format, row.format);
    EXPECT_EQ(dataset.points.size(), row.points);
    EXPECT_EQ(count_cells(dataset), row.cells);
    EXPECT_EQ(dataset.skipped_blocks, row.skipped_blocks);
    constexpr double digits = 1e-5;  // SOURCES.md gives six
    if (*row.field != '\0') {
        const bool on_points = std::any_of(dataset.point_fields.begin(), dataset.point_fields.end(),
                                           [&](const Field& f) { return f.name == row.field; });
        const Field& found = field(on_points ? dataset.point_fields : dataset.cell_fields, row.field);
        const ScalarRange values = range(as_scalar(found, FieldLocation::points).values);
        const double largest = std::max(std::abs(row.low), std::abs(row.high));
        EXPECT_NEAR(values.low, row.low, digits * largest);
        EXPECT_NEAR(values.high, row.high, digits * largest);
    } else {
        EXPECT_TRUE(dataset.point_fields.empty());
    }
    if (row.volume > 0) {
        EXPECT_NEAR(volume_of(dataset), row.volume, row.volume_tolerance * row.volume);
    }
}

// The name of the file, with its options' mark; letters and digits only, as ctest wants them.
std::string test_name(const char* file, std::size_t index) {
    std::string name = fs::path(file).filename().string() + "_" + std::to_string(index);
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Files, SharedDataVolume, testing::ValuesIn(rows()),
                         [](const auto& row) { return test_name(row.param.file, row.index); });

// ---- Surfaces ----

struct SurfaceRow {
    const char* file;
    std::size_t points, polygons;
};

void PrintTo(const SurfaceRow& row, std::ostream* stream) {
    *stream << row.file;
}

// STL lists the corners of each triangle anew; SOURCES.md counts them merged (10,204 and 598).
constexpr std::array<SurfaceRow, 7> surface_rows{{{"aneurysm_tets_openfoam/aneurysm_data_binary.stl", 3 * 20294, 20294},
                                                  {"surfaces/elephant.off", 2775, 5558},
                                                  {"surfaces/fandisk.off", 6475, 12946},
                                                  {"surfaces/elephant-with-holes.off", 2798, 4463},
                                                  {"surfaces/camel.off", 9770, 19536},
                                                  {"surfaces/oblong-shuffled.off", 424, 840},
                                                  {"surfaces/hinge.stl", 3 * 1212, 1212}}};

class SharedDataSurface : public testing::TestWithParam<SurfaceRow> {};

TEST_P(SharedDataSurface, IsAsSourcesSay) {
    const fs::path file = fs::path(data) / GetParam().file;
    if (!fs::exists(file)) GTEST_SKIP() << "needs " << file;
    const Surface surface = read_surface(file);
    EXPECT_EQ(surface.points.size(), GetParam().points);
    EXPECT_EQ(surface.polygons.size(), GetParam().polygons);
}

INSTANTIATE_TEST_SUITE_P(Files, SharedDataSurface, testing::ValuesIn(surface_rows),
                         [](const auto& row) { return test_name(row.param.file, row.index); });

// ---- All others ----

struct Companion {
    const char* path;  // a file, or a folder that ends in "/"
    const char* reason;
};

constexpr std::array<Companion, 30> companions{
    {{"SOURCES.md", "about the others"},
     {"LICENSES/", "about the others"},
     {"openfoam_case/Copyright.txt", "about the others"},
     {"bluntfin/bluntfinq.bin", "the solution of bluntfinxyz.bin"},
     {"combustor/combq.bin", "the solution of combxyz.bin"},
     {"flange_openfoam/ensight/data/", "values of flange.case"},
     {"flange_openfoam/ensight/geometry", "the mesh of flange.case"},
     {"ensight_nfaced/test.geo", "the mesh of TEST.case"},
     {"ensight_nfaced/test.extr_pressure.0001", "values of TEST.case"},
     {"ensight_nfaced/test.extr_velocity.0001", "values of TEST.case"},
     {"ensight_nfaced/test.pressure.0001", "values of TEST.case"},
     {"ensight_nfaced/test.velocity.0001", "values of TEST.case"},
     {"ensight_nfaced/test_bin.geo", "the mesh of TEST_bin.case"},
     {"ensight_nfaced/test_bin.extr_pressure.0001", "values of TEST_bin.case"},
     {"ensight_nfaced/test_bin.extr_velocity.0001", "values of TEST_bin.case"},
     {"ensight_nfaced/test_bin.pressure.0001", "values of TEST_bin.case"},
     {"ensight_nfaced/test_bin.velocity.0001", "values of TEST_bin.case"},
     {"openfoam_case/64BitFloats/.directory", "a desktop's settings"},
     {"openfoam_case/64BitFloats/0/", "values of the case"},
     {"openfoam_case/64BitFloats/constant/", "the mesh of the case"},
     {"openfoam_case/64BitFloats/system/", "settings of the case"},
     {"openfoam_case/cavity/0/", "values of the case"},
     {"openfoam_case/cavity/0.5/", "values of the case"},
     {"openfoam_case/cavity/1/", "values of the case"},
     {"openfoam_case/cavity/1.5/", "values of the case"},
     {"openfoam_case/cavity/2/", "values of the case"},
     {"openfoam_case/cavity/2.5/", "values of the case"},
     {"openfoam_case/cavity/constant/", "the mesh of the case"},
     {"openfoam_case/cavity/system/", "settings of the case"},
     {"medit/torus.sol", "values of torus.mesh"}}};

// What is no mesh of volumes is refused, with a word on what to do.
struct Refused {
    const char* file;
    const char* words;
};

constexpr std::array<Refused, 3> refused{{{"calculix/segmenttet.frd", "CalculiX"},
                                          {"tetgen/example.1.face", "the .ele file"},
                                          {"tetgen/example.poly", "cellproj tetrahedralize"}}};

class SharedData : public ReadSharedData {};

TEST_F(SharedData, EveryFileIsAccountedFor) {
    std::set<std::string> known;
    for (const Row& row : rows())
        known.insert(row.file);
    for (const SurfaceRow& row : surface_rows)
        known.insert(row.file);
    for (const Refused& file : refused)
        known.insert(file.file);
    const auto is_companion = [](const std::string& path) {
        return std::any_of(companions.begin(), companions.end(), [&](const Companion& c) {
            const std::string place = c.path;
            return place.ends_with('/') ? path.starts_with(place) : path == place;
        });
    };
    for (const auto& entry : fs::recursive_directory_iterator(data)) {
        if (!entry.is_regular_file()) continue;
        const std::string path = entry.path().lexically_relative(data).generic_string();
        EXPECT_TRUE(known.contains(path) || is_companion(path)) << path << " is in no list of this test";
    }
}

TEST_F(SharedData, TheOthersAreRefusedWithAdvice) {
    for (const Refused& file : refused) {
        const Error error = error_of(data / file.file);
        EXPECT_EQ(error.kind(), ErrorKind::format);
        EXPECT_NE(error.advice().find(file.words), std::string::npos) << error.what();
    }
    EXPECT_EQ(error_of(data / "medit/torus.sol").kind(), ErrorKind::data);
}

}  // namespace
}  // namespace cellproj
