// SPDX-License-Identifier: BSD-3-Clause
//
// Surface files to surfaces, and the fields that a mesh takes over from its surface.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "mesh/surface.hpp"
#include "tests/surface_fixtures.hpp"

namespace cellproj {
namespace surface_test {

namespace fs = std::filesystem;
using mesher_fixtures::error_of;

// The tetrahedron between the origin and the unit vectors: volume 1/6.
Surface corner() {
    return {"corner", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}};
}

std::string numbers(const glm::dvec3& p) {
    return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z);
}

std::string off(const Surface& surface, const std::string& keyword = "OFF\n") {
    std::string text =
        keyword + std::to_string(surface.points.size()) + " " + std::to_string(surface.polygons.size()) + " 0\n";
    for (const glm::dvec3& p : surface.points)
        text += numbers(p) + "\n";
    for (const auto& polygon : surface.polygons) {
        text += std::to_string(polygon.size());
        for (const VertexId v : polygon)
            text += " " + std::to_string(v);
        text += "\n";
    }
    return text;
}

std::string ply(const Surface& surface) {
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(surface.points.size()) +
                       "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                       std::to_string(surface.polygons.size()) +
                       "\nproperty list uchar int vertex_indices\nend_header\n";
    const std::string body = off(surface, "");
    return text + body.substr(body.find('\n') + 1);
}

// Big-endian, with a property that is no coordinate and faces before vertices.
std::string binary_ply(const Surface& surface) {
    std::string bytes =
        "ply\nformat binary_big_endian 1.0\ncomment by hand\nelement face " + std::to_string(surface.polygons.size()) +
        "\nproperty list uint8 uint16 vertex_index\nelement vertex " + std::to_string(surface.points.size()) +
        "\nproperty uchar red\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    const auto append = [&](const auto& value) {
        std::string number(reinterpret_cast<const char*>(&value), sizeof(value));
        bytes.append(number.rbegin(), number.rend());  // this machine is little-endian
    };
    for (const auto& polygon : surface.polygons) {
        append(static_cast<std::uint8_t>(polygon.size()));
        for (const VertexId v : polygon)
            append(static_cast<std::uint16_t>(v));
    }
    for (const glm::dvec3& p : surface.points) {
        append(std::uint8_t{255});
        for (int axis = 0; axis < 3; ++axis)
            append(p[axis]);
    }
    return bytes;
}

std::string obj(const Surface& surface) {
    std::string text = "# a comment\n";
    for (const glm::dvec3& p : surface.points)
        text += "v " + numbers(p) + "\n";
    for (const auto& polygon : surface.polygons) {
        text += "f";
        for (const VertexId v : polygon)
            text += " " + std::to_string(v + 1);
        text += "\n";
    }
    return text;
}

std::string ascii_stl(const Surface& surface) {
    std::string text = "solid corner\n";
    for (const auto& polygon : surface.polygons) {
        text += "facet normal 0 0 1\nouter loop\n";
        for (const VertexId v : polygon)
            text += "vertex " + numbers(surface.points[v]) + "\n";
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid corner\n";
}

// Its free text begins with "solid", as that of many programs does.
std::string binary_stl(const Surface& surface) {
    std::string bytes = "solid but binary";
    bytes.resize(80, ' ');
    const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
    append(static_cast<std::uint32_t>(surface.polygons.size()));
    for (const auto& polygon : surface.polygons) {
        for (int i = 0; i < 3; ++i)
            append(0.0F);
        for (const VertexId v : polygon) {
            for (int axis = 0; axis < 3; ++axis)
                append(static_cast<float>(surface.points[v][axis]));
        }
        append(std::uint16_t{0});
    }
    return bytes;
}

std::string vtp(const Surface& surface) {
    std::string points, vertices, offsets, values;
    std::size_t end = 0;
    for (const glm::dvec3& p : surface.points) {
        points += numbers(p) + " ";
        values += std::to_string(p.x + 2.0 * p.y) + " ";
    }
    for (const auto& polygon : surface.polygons) {
        for (const VertexId v : polygon)
            vertices += std::to_string(v) + " ";
        offsets += std::to_string(end += polygon.size()) + " ";
    }
    const auto array = [](const std::string& attributes, const std::string& content) {
        return "<DataArray format=\"ascii\" " + attributes + ">" + content + "</DataArray>";
    };
    return "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData><Piece NumberOfPoints=\"" +
           std::to_string(surface.points.size()) + "\" NumberOfPolys=\"" + std::to_string(surface.polygons.size()) +
           "\"><PointData>" + array("type=\"Float64\" Name=\"s\"", values) + "</PointData><Points>" +
           array("type=\"Float64\" NumberOfComponents=\"3\"", points) + "</Points><Polys>" +
           array("type=\"Int64\" Name=\"connectivity\"", vertices) + array("type=\"Int64\" Name=\"offsets\"", offsets) +
           "</Polys></Piece></PolyData></VTKFile>";
}

// By the divergence theorem, polygons as fans.
double enclosed_volume(const Surface& surface) {
    double volume = 0.0;
    for (const auto& polygon : surface.polygons) {
        for (std::size_t i = 2; i < polygon.size(); ++i) {
            const glm::dvec3 &a = surface.points[polygon[0]], &b = surface.points[polygon[i - 1]],
                             &c = surface.points[polygon[i]];
            volume += glm::dot(a, glm::cross(b, c)) / 6.0;
        }
    }
    return volume;
}

TEST_F(SurfaceFile, EveryFormatGivesTheSameSurface) {
    const Surface surface = corner();
    const std::pair<const char*, std::string> files[] = {{"a.off", off(surface)},
                                                         {"a.ply", ply(surface)},
                                                         {"a.obj", obj(surface)},
                                                         {"ascii.stl", ascii_stl(surface)},
                                                         {"binary.stl", binary_stl(surface)},
                                                         {"a.vtp", vtp(surface)},
                                                         {"b.ply", binary_ply(surface)},
                                                         {"no_suffix", off(surface)},
                                                         {"wrong.obj", ply(surface)}};
    for (const auto& [name, bytes] : files) {
        const Surface read = read_surface(write(name, bytes));
        EXPECT_EQ(read.polygons.size(), 4U) << name;
        EXPECT_DOUBLE_EQ(enclosed_volume(read), 1.0 / 6.0) << name;  // 0 and 1 are exact in every format
        EXPECT_EQ(read.name, (folder_ / name).string());
    }
}

TEST_F(SurfaceFile, VtpBringsItsPointFields) {
    const Surface read = read_surface(write("a.vtp", vtp(corner())));
    ASSERT_EQ(read.point_fields.size(), 1U);
    EXPECT_EQ(read.point_fields[0].name, "s");
    EXPECT_EQ(read.point_fields[0].values, (std::vector<double>{0, 1, 2, 0}));
}

TEST_F(SurfaceFile, OffAllowsCommentsColoursAndCountsBesideTheKeyword) {
    const std::string text =
        "# made by hand\n\nCOFF 4 1 0 # counts\n0 0 0 255 0 0 255\r\n+1 0 0 0 0 0 0\n\n1 1 0\n0 1e0 0\n"
        "4 0 1 2 3 0.5 0.5 0.5\n";
    const Surface read = read_surface(write("a.off", text));
    EXPECT_EQ(read.points[1], glm::dvec3(1, 0, 0));
    ASSERT_EQ(read.polygons.size(), 1U);
    EXPECT_EQ(read.polygons[0], (std::vector<VertexId>{0, 1, 2, 3}));
}

TEST_F(SurfaceFile, BrokenOffIsRefusedByLine) {
    const std::string good = off(corner());
    expect_refused("a.off", "OFF\n1 1\n0 0 x\n3 0 0 0\n", "line 3: expected three coordinates, found \"x\"");
    expect_refused("a.off", "OFF\n4 99999999999 0\n", "line 2: expected as many vertices and faces");
    expect_refused("a.off", "OFF BINARY\n", "found \"BINARY\"");
    expect_refused("a.off", "4OFF\n1 1 0\n", "\"4OFF\"");
    expect_refused("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 9\n", "facet 0 with id 9");
    expect_refused("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 -1\n",
                   "line 7: expected vertex 2 of a face, found \"-1\"");
    expect_refused("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 nan\n3 0 1 2\n", "point 3 is not finite");
}

// At every length: an Error, or, where only the last figures are lost, a surface.
TEST_F(SurfaceFile, CutFilesDoNoHarm) {
    const Surface surface = corner();
    for (const auto& [name, bytes] : {std::pair{"a.off", off(surface)},
                                      {"a.stl", ascii_stl(surface)},
                                      {"b.stl", binary_stl(surface)},
                                      {"a.vtp", vtp(surface)},
                                      {"a.ply", ply(surface)},
                                      {"b.ply", binary_ply(surface)}}) {
        std::size_t refused = 0;
        for (std::size_t i = 0; i < 20; ++i) {
            const fs::path file = write(name, bytes.substr(0, bytes.size() * i / 20));
            try {
                read_surface(file);
            } catch (const Error& error) {
                ++refused;
                EXPECT_NE(error.place().find(file.string()), std::string::npos) << error.what();
            }
        }
        EXPECT_EQ(refused, 20U) << name;
    }
}

TEST_F(SurfaceFile, OtherFilesAreRefused) {
    expect_refused("a.txt", "hello\n", "a surface: STL, OFF, PLY, OBJ, VTP, or TetGen's .poly or .smesh");
    expect_refused("a.obj", "hello\n", "no polygons");
    EXPECT_EQ(error_of([&] { read_surface(folder_ / "none.stl"); }).kind(), ErrorKind::file);
}

TEST(SurfaceFields, DistanceToACubeIsThatToItsNearestFace) {
    PiecewiseLinearComplex cube;
    mesher_fixtures::add_box(cube, {0, 0, 0}, {1, 1, 1});
    TetMesh mesh;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 2.0);
    for (int i = 0; i < 500; ++i)
        mesh.points.emplace_back(uniform(random), uniform(random), uniform(random));
    carry_fields({"cube", cube.points, cube.facets, {}}, mesh);
    ASSERT_EQ(mesh.point_fields.size(), 1U);
    EXPECT_EQ(mesh.point_fields[0].name, "distance");
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        // The signed distance of a box: outside by its corner region, inside by the nearest face.
        const glm::dvec3 q = glm::abs(mesh.points[i] - 0.5) - 0.5;
        const double outside = glm::length(glm::max(q, 0.0));
        const double expected = outside > 0.0 ? outside : -std::max({q.x, q.y, q.z});
        EXPECT_NEAR(mesh.point_fields[0].values[i], expected, 1e-15);  // a few roundings of numbers up to 2
    }
}

TEST(SurfaceFields, LinearFieldIsCarriedOverExactlyOnTheSurface) {
    Surface surface = corner();
    surface.point_fields = {{"v", 2, {0, 5, 1, 5, 2, 5, 3, 5}}};  // v.x = x + 2y + 3z, v.y = 5
    TetMesh mesh;
    mesh.points = {{0.25, 0.25, 0.5}, {0.3, 0.2, 0.0}, {1, 0, 0}, {-1, -1, -1}, {2, 0, 0}};
    carry_fields(surface, mesh);
    ASSERT_EQ(mesh.point_fields.size(), 1U);
    const std::vector<double> expected{2.25, 5, 0.7, 5, 1, 5, 0, 5, 1, 5};  // the last two: at the nearest corner
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(mesh.point_fields[0].values[i], expected[i], 1e-15);
}

TEST(SurfaceFields, CornersWithoutWeightDoNotCount) {
    Surface surface = corner();
    surface.point_fields = {{"s", 1, {7, std::numeric_limits<double>::quiet_NaN(), 8, 9}}};
    TetMesh mesh;
    mesh.points = {{0, 0, 0}};
    carry_fields(surface, mesh);
    EXPECT_EQ(mesh.point_fields[0].values[0], 7.0);
}

}  // namespace
}  // namespace cellproj
