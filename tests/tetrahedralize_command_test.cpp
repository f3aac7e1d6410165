// SPDX-License-Identifier: BSD-3-Clause
//
// From surfaces, clean and dirty, to volumes: by the library, and by the program as a user meets it.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "mesh/mesher.hpp"
#include "mesh/mesher_format.hpp"
#include "mesh/surface.hpp"
#include "tests/mesher_fixtures.hpp"
#include "tests/support/folder_test.hpp"

namespace cellproj {
namespace tetrahedralize_command_test {

namespace fs = std::filesystem;
using mesher_fixtures::add_box;
using mesher_fixtures::error_of;
using testing_support::FolderTest;
using testing_support::Outcome;

Surface boxes(std::initializer_list<std::array<glm::dvec3, 2>> corners) {
    PiecewiseLinearComplex complex;
    for (const auto& [low, high] : corners)
        add_box(complex, low, high);
    return {"boxes", complex.points, complex.facets, {}};
}

Surface cube() {
    return boxes({{glm::dvec3(0.0), glm::dvec3(1.0)}});
}

// Every polygon with points of its own, as in STL.
Surface soup_of(const Surface& surface) {
    Surface soup{surface.name, {}, {}, {}};
    for (const auto& polygon : surface.polygons) {
        auto& own = soup.polygons.emplace_back();
        for (const VertexId v : polygon) {
            own.push_back(static_cast<VertexId>(soup.points.size()));
            soup.points.push_back(surface.points[v]);
        }
    }
    return soup;
}

double volume(const TetMesh& mesh) {
    double sum = 0.0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell)
        sum += signed_volume(mesh, cell);
    return sum;
}

// By the divergence theorem, about the middle of the surface; for triangles that agree in their orientation.
double enclosed_volume(const Surface& surface) {
    const glm::dvec3 origin = bounds(surface.points).center();
    double sum = 0.0;
    for (const auto& t : surface.polygons) {
        sum += glm::dot(surface.points[t[0]] - origin,
                        glm::cross(surface.points[t[1]] - origin, surface.points[t[2]] - origin)) /
               6.0;
    }
    return std::abs(sum);
}

// Error (data) that names the surface and says `words`.
void expect_refused(const Surface& surface, const std::string& words, const MesherOptions& options = {}) {
    const Error error = error_of([&] { tetrahedralize(surface, options); });
    EXPECT_EQ(error.kind(), ErrorKind::data) << error.what();
    EXPECT_EQ(error.place(), surface.name);
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    EXPECT_FALSE(error.advice().empty());
}

constexpr double rounding = 1e-12;  // sums of some thousand products of numbers of order 1

TEST(SurfaceMeshing, CubeIsFilledHoweverItIsStored) {
    EXPECT_NEAR(volume(tetrahedralize(cube())), 1.0, rounding);
    EXPECT_NEAR(volume(tetrahedralize(soup_of(cube()))), 1.0, rounding);
    Surface inside_out = cube();
    for (auto& polygon : inside_out.polygons)
        std::reverse(polygon.begin(), polygon.end());
    EXPECT_NEAR(volume(tetrahedralize(inside_out)), 1.0, rounding);
    Surface shuffled = soup_of(cube());
    std::reverse(shuffled.polygons[1].begin(), shuffled.polygons[1].end());
    std::reverse(shuffled.polygons[4].begin(), shuffled.polygons[4].end());
    EXPECT_NEAR(volume(tetrahedralize(shuffled)), 1.0, rounding);
    Surface repeated = cube();
    repeated.polygons.push_back(repeated.polygons[2]);
    EXPECT_NEAR(volume(tetrahedralize(repeated)), 1.0, rounding);
}

TEST(SurfaceMeshing, SheetsWithinSheetsAlternate) {
    const Surface nested = boxes({{glm::dvec3(0.0), glm::dvec3(1.0)},
                                  {glm::dvec3(0.2), glm::dvec3(0.8)},
                                  {glm::dvec3(0.4), glm::dvec3(0.6)},
                                  {glm::dvec3(2.0), glm::dvec3(3.0)}});
    MesherOptions options;
    options.max_volume = 0.01;
    const TetMesh mesh = tetrahedralize(nested, options);
    EXPECT_NEAR(volume(mesh), 1.0 - 0.216 + 0.008 + 1.0, rounding);
    EXPECT_TRUE(mesh.cell_fields.empty());
    std::vector<bool> used(mesh.points.size());
    for (const auto& tet : mesh.tets) {
        for (const VertexId v : tet)
            used[v] = true;
    }
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST(SurfaceMeshing, CellsKeepTheVolumeBoundAndHaveTheDistance) {
    MesherOptions options;
    options.max_volume = 0.002;
    const TetMesh mesh = tetrahedralize(cube(), options);
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell)
        EXPECT_LE(signed_volume(mesh, cell), 0.002 * (1 + 1e-9));
    ASSERT_EQ(mesh.point_fields.size(), 1U);
    const auto& distance = mesh.point_fields[0].values;
    EXPECT_EQ(mesh.point_fields[0].name, "distance");
    // A ball without a vertex is at most as large as a few cells, so some vertex is well inside.
    EXPECT_GT(*std::max_element(distance.begin(), distance.end()), 0.25);
    EXPECT_LE(*std::max_element(distance.begin(), distance.end()), 0.5);
}

TEST(SurfaceMeshing, OpenSurfaceIsRefusedOrFilled) {
    Surface open = cube();
    open.polygons.pop_back();
    expect_refused(open, "found 4 open edges around 1 hole;");
    open.polygons.erase(open.polygons.begin() + 4);
    expect_refused(open, "found 8 open edges around 2 holes;");
    MesherOptions options;
    options.fill_holes = true;
    EXPECT_NEAR(volume(tetrahedralize(open, options)), 1.0, rounding);
}

TEST(SurfaceMeshing, SelfIntersectionsAreToldByFacet) {
    const Surface crossing = boxes({{glm::dvec3(0.0), glm::dvec3(1.0)}, {glm::dvec3(0.5), glm::dvec3(1.5)}});
    // Three faces at the corner of each box are cut, each by two of the other's.
    expect_refused(crossing, "6 pairs of facets that cross or touch: 1 and ");
    expect_refused(soup_of(crossing), "6 pairs of facets");
}

TEST(SurfaceMeshing, NonManifoldEdgeIsRefused) {
    Surface touching =
        boxes({{glm::dvec3(0.0), glm::dvec3(1.0)}, {glm::dvec3(1.0, 1.0, 0.0), glm::dvec3(2.0, 2.0, 1.0)}});
    expect_refused(touching, "1 non-manifold edge, the first between the facets 3, 5, 8, 10");
}

TEST(SurfaceMeshing, NothingToFillIsRefused) {
    expect_refused({"empty", {}, {}, {}}, "no polygons");
    expect_refused(
        {"flat", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}, {0, 1, 3}}, {}},
        "all lie in one plane (volume 0)");
    expect_refused({"a point", std::vector<glm::dvec3>(4), {{0, 1, 2}, {0, 1, 3}}, {}},
                   "no facet with three different points");
}

TEST(SurfaceMeshing, BrokenMesherIsAnError) {
    const fs::path script = testing_support::scratch_folder() / "mesher.sh";
    MesherOptions options;
    options.program = script;
    options.timeout_seconds = 0.5;
    const std::pair<const char*, const char*> mishaps[] = {
        {"kill -SEGV $$", "died of SIGSEGV"}, {"sleep 600", "no answer after 0.5 s"}, {"echo garbage", "cpmesher"}};
    for (const auto& [line, words] : mishaps) {
        std::ofstream(script) << "#!/bin/sh\n" << line << '\n';
        fs::permissions(script, fs::perms::owner_all);
        const Error error = error_of([&] { tetrahedralize(cube(), options); });
        EXPECT_EQ(error.kind(), ErrorKind::mesher);
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
}

TEST(SurfaceMeshing, MessagesSurviveTheExchange) {
    SurfaceRequest request{cube(), true, 0.5, 1.5, 0.02};
    request.surface.facets = {0, 0, 1, 2, 3, 4};
    request.surface.inside = Inside::enclosed;
    request.surface.holes = {{1, 2, 3}};
    request.surface.regions = {{{4, 5, 6}, 7, 8}};
    const SurfaceRequest back = decode_surface_request(encode_request(request), "test");
    EXPECT_EQ(back.surface.points, request.surface.points);
    EXPECT_EQ(back.surface.polygons, request.surface.polygons);
    EXPECT_TRUE(back.fill_holes);
    EXPECT_EQ(back.max_volume, 0.5);
    EXPECT_EQ(back.radius_edge_ratio, 1.5);
    EXPECT_EQ(back.wrap, 0.02);
    EXPECT_EQ(back.surface.facets, request.surface.facets);
    EXPECT_EQ(back.surface.inside, Inside::enclosed);
    EXPECT_EQ(back.surface.holes, request.surface.holes);
    ASSERT_EQ(back.surface.regions.size(), 1U);
    EXPECT_EQ(back.surface.regions[0].seed, glm::dvec3(4, 5, 6));
    EXPECT_EQ(back.surface.regions[0].attribute, 7);
    EXPECT_EQ(back.surface.regions[0].max_volume, 8);

    const Error error({.kind = ErrorKind::data, .place = "there", .expected = "a", .found = "b…", .advice = ""});
    const std::string refusal = encode_refusal({error, {{2, 7}, {3, new_facet}}});
    EXPECT_TRUE(is_refusal(refusal));
    EXPECT_FALSE(is_refusal(encode_request(request)));
    EXPECT_EQ(decode_refusal(refusal, "test", "here").error.found(), "b…");
    EXPECT_EQ(decode_refusal(refusal, "test", "here").error.place(), "here");
    EXPECT_EQ(decode_refusal(refusal, "test", "here").intersections,
              (std::vector<std::array<std::uint32_t, 2>>{{2, 7}, {3, new_facet}}));
    EXPECT_EQ(error_of([&] { decode_refusal(refusal.substr(0, refusal.size() - 1), "test", "here"); }).kind(),
              ErrorKind::mesher);
}

// ---- The program, and files ----

class TetrahedralizeCommand : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        write("corner.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    }

    Outcome run(const std::string& arguments) const { return run_program("tetrahedralize " + arguments); }
    Outcome run_program(const std::string& arguments) const { return testing_support::run_program(folder_, arguments); }

    std::ptrdiff_t file_count() const {
        return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
    }

    // CPU time of the programs that have ended [s]: a busy machine takes longer by the clock.
    static double seconds_of_programs() {
        rusage usage{};
        getrusage(RUSAGE_CHILDREN, &usage);
        return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec);
    }

    // Exit status 1, one line, nothing left in the folder, within 10 s.
    void expect_refusal(const std::string& arguments, const std::string& words) const {
        const auto before = file_count();
        const double start = seconds_of_programs();
        const Outcome outcome = run(arguments);
        EXPECT_LT(seconds_of_programs() - start, 10) << arguments;
        EXPECT_EQ(outcome.code, 1) << outcome.text;
        EXPECT_NE(outcome.text.find(words), std::string::npos) << outcome.text;
        EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
        EXPECT_EQ(file_count(), before) << arguments;
    }

    static fs::path shared(const std::string& name) { return fs::path(CELLPROJ_SHARED_DATA) / name; }
};

TEST_F(TetrahedralizeCommand, WritesAMeshThatVtkReads) {
    const Outcome outcome = run("corner.off -o corner.vtu --max-volume 0.001");
    ASSERT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_EQ(file_count(), 2);
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    reader->SetFileName((folder_ / "corner.vtu").c_str());
    reader->Update();
    vtkUnstructuredGrid& grid = *reader->GetOutput();
    EXPECT_GE(grid.GetNumberOfCells(), 167);
    EXPECT_EQ(outcome.text,
              "corner.vtu: " + std::to_string(grid.GetNumberOfCells()) + " tetrahedra, volume 0.166666667\n");
    EXPECT_EQ(grid.GetCellType(0), VTK_TETRA);
    ASSERT_NE(grid.GetPointData()->GetArray("distance"), nullptr);
    EXPECT_EQ(grid.GetPointData()->GetArray("distance")->GetNumberOfTuples(), grid.GetNumberOfPoints());
}

std::string off_of(const Surface& surface) {
    std::string text = "OFF\n" + std::to_string(surface.points.size()) + " " + std::to_string(surface.polygons.size()) + " 0\n";
    for (const glm::dvec3& p : surface.points)
        text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    for (const auto& polygon : surface.polygons) {
        text += std::to_string(polygon.size());
        for (const VertexId v : polygon)
            text += " " + std::to_string(v);
        text += "\n";
    }
    return text;
}

TEST_F(TetrahedralizeCommand, HolesAndRegionsAreOptions) {
    std::ofstream(folder_ / "nested.off") << off_of(
        boxes({{glm::dvec3(0.0), glm::dvec3(1.0)}, {glm::dvec3(0.25), glm::dvec3(0.75)}, {glm::dvec3(2.0), glm::dvec3(3.0)}}));
    const std::string places = "nested.off -o mesh.vtu --region 0.1,0.1,0.1 --region .5,.5,.5:-7:0.001 ";
    const Outcome regions = run(places + "--region 2.5,2.5,2.5:7");
    ASSERT_EQ(regions.code, 0) << regions.text;
    for (const char* words : {" tetrahedra, volume 2\n", "region 1: ", "volume 0.875\n", "region -7: ", "volume 0.125\n", "region 7: "})
        EXPECT_NE(regions.text.find(words), std::string::npos) << words << "\n" << regions.text;
    const Outcome hole = run(places + "--hole 2.5,2.5,2.5");
    EXPECT_NE(hole.text.find(" tetrahedra, volume 1\n"), std::string::npos) << hole.text;
    // A region in a void is a mistake.
    expect_refusal(places + "--hole .5,.5,.5", "region 1 (attribute -7) at 0.5, 0.5, 0.5, which is outside or in a hole");
    expect_refusal("nested.off -o x.vtu --hole 1,2", "a point X,Y,Z, found \"1,2\"");
    expect_refusal("nested.off -o x.vtu --region 1,2,3:a", "X,Y,Z:ATTRIBUTE:MAXVOLUME, found \"1,2,3:a\"");
    expect_refusal("nested.off -o x.vtu --region 1,2,3:4:-1", "MAXVOLUME");
    expect_refusal("nested.off -o x.vtu --hole .5,.5,.5 --fill-holes", "fill_holes");
}

TEST_F(TetrahedralizeCommand, CrossingFacetsAreShown) {
    std::ofstream(folder_ / "crossing.off") << off_of(
        boxes({{glm::dvec3(0.0), glm::dvec3(1.0)}, {glm::dvec3(0.5), glm::dvec3(1.5)}}));
    expect_refusal("crossing.off -o mesh.vtu", "(--intersections FILE.vtp shows where; facets count from 0)");
    expect_refusal("crossing.off -o mesh.vtu --intersections x.stl", "a name that ends in .vtp");
    const Outcome outcome = run("crossing.off -o mesh.vtu --intersections x.vtp");
    EXPECT_EQ(outcome.code, 1) << outcome.text;
    EXPECT_NE(outcome.text.find("x.vtp: 6 facets that cross or touch others"), std::string::npos) << outcome.text;
    EXPECT_FALSE(fs::exists(folder_ / "mesh.vtu"));
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName((folder_ / "x.vtp").c_str());
    reader->Update();
    vtkCellData& data = *reader->GetOutput()->GetCellData();
    ASSERT_EQ(reader->GetOutput()->GetNumberOfPolys(), 6);
    ASSERT_NE(data.GetArray("facet"), nullptr);
    const std::array<int, 6> facets{1, 3, 5, 6, 8, 10};
    for (vtkIdType i = 0; i < 6; ++i) {
        EXPECT_EQ(data.GetArray("facet")->GetTuple1(i), facets[static_cast<std::size_t>(i)]);
        EXPECT_EQ(data.GetArray("crossed")->GetTuple1(i), 2);
    }
    const Outcome clean = run("corner.off -o mesh.vtu --intersections y.vtp");
    EXPECT_EQ(clean.code, 0);
    EXPECT_NE(clean.text.find("no facets cross or touch: y.vtp is not written"), std::string::npos) << clean.text;
    EXPECT_FALSE(fs::exists(folder_ / "y.vtp"));
}

TEST_F(TetrahedralizeCommand, SurfacesAreToldFromMeshesAndRendered) {
    const Outcome info = run_program("info corner.off");
    EXPECT_EQ(info.code, 0) << info.text;
    EXPECT_NE(info.text.find("a surface, OFF"), std::string::npos) << info.text;
    EXPECT_NE(info.text.find("facets      4\n"), std::string::npos) << info.text;
    EXPECT_NE(info.text.find("cellproj render corner.off --tetrahedralize -o picture.png"), std::string::npos) << info.text;
    fs::copy(folder_ / "corner.off", folder_ / "a corner.off");
    const Outcome blank = run_program("info 'a corner.off'");
    EXPECT_NE(blank.text.find("cellproj tetrahedralize 'a corner.off' -o 'a corner.vtu'\n"), std::string::npos) << blank.text;
    const Outcome unfilled = run_program("render corner.off -o corner.png");
    EXPECT_EQ(unfilled.code, 1);
    EXPECT_NE(unfilled.text.find("found a surface (OFF); fill it: cellproj render corner.off --tetrahedralize"), std::string::npos)
        << unfilled.text;
    EXPECT_EQ(run_program("render corner.off -o corner.png --wrap 0.1").code, 2);
    const Outcome filled = run_program("render corner.off --tetrahedralize -o corner.png --size 64x64");
    EXPECT_EQ(filled.code, 0) << filled.text;
    EXPECT_TRUE(fs::exists(folder_ / "corner.png"));
    EXPECT_EQ(filled.text.find("blank"), std::string::npos) << filled.text;  // the default bound leaves points inside
    const Outcome mesh = run_program("render corner.png --tetrahedralize -o x.png");
    EXPECT_NE(mesh.text.find("expected a surface"), std::string::npos) << mesh.text;
}

TEST_F(TetrahedralizeCommand, BadOptionsAreRefused) {
    expect_refusal("corner.off -o corner.stl", "a name that ends in .vtu");
    expect_refusal("corner.off -o missing/corner.vtu", "No such file or directory");
    expect_refusal("missing.off -o corner.vtu", "check the path");
    expect_refusal("corner.off -o corner.vtu --max-volume -1", "max_volume");
    expect_refusal("corner.off -o corner.vtu --timeout 0", "timeout_seconds");
    expect_refusal("corner.off -o corner.vtu --wrap 2", "wrap");
    EXPECT_EQ(run("corner.off").code, 2);
}

TEST_F(TetrahedralizeCommand, CleanSurfacesFillToTheirVolume) {
    for (const char* name : {"elephant.off", "fandisk.off", "hinge.stl"}) {
        const fs::path file = shared("surfaces") / name;
        if (!fs::exists(file)) GTEST_SKIP() << "no ../shared/data/surfaces";
        const Surface surface = read_surface(file);
        MesherOptions options;
        options.radius_edge_ratio = 1.414;
        const double expected = enclosed_volume(surface);
        // TetGen takes facets that are almost in one plane as one, and may change the diagonals there: 2e-7 was seen.
        EXPECT_NEAR(volume(tetrahedralize(surface, options)), expected, 1e-5 * expected) << name;
    }
}

TEST_F(TetrahedralizeCommand, DirtySurfacesGetTheirOwnMessages) {
    if (!fs::exists(shared("surfaces"))) GTEST_SKIP() << "no ../shared/data/surfaces";
    const auto input = [](const fs::path& name) { return "'" + shared(name).string() + "' -o mesh.vtu"; };
    expect_refusal(input("surfaces/camel.off"), "pairs of facets that cross or touch: 2416 and 3411");
    expect_refusal(input("surfaces/elephant-with-holes.off"), "1353 open edges around");
    expect_refusal(input("aneurysm_tets_openfoam/aneurysm_data_binary.stl"), "116 open edges around 3 holes");
    // Its facets are turned at random and two points are stored twice, which can be repaired.
    const Outcome shuffled = run(input("surfaces/oblong-shuffled.off"));
    EXPECT_EQ(shuffled.code, 0) << shuffled.text;
}

// Another mesher (Gmsh, cells of 0.8 mm, flat facets on the curved wall) filled 9503.39 mm³ of the same vessel.
TEST_F(TetrahedralizeCommand, CappedAneurysmHasTheVolumeOfItsCfdMesh) {
    const fs::path file = shared("aneurysm_tets_openfoam/aneurysm_data_binary.stl");
    if (!fs::exists(file)) GTEST_SKIP() << "no ../shared/data/aneurysm_tets_openfoam";
    MesherOptions options;
    options.fill_holes = true;
    EXPECT_NEAR(volume(tetrahedralize(read_surface(file), options)), 9503.39, 0.01 * 9503.39);
}

}  // namespace
}  // namespace cellproj
