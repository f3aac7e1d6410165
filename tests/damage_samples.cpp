// SPDX-License-Identifier: BSD-3-Clause
#include "tests/damage_samples.hpp"

#include <vtkCellData.h>
#include <vtkDataSetWriter.h>
#include <vtkDoubleArray.h>
#include <vtkExodusIIWriter.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMetaImageWriter.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkSTLWriter.h>
#include <vtkSmartPointer.h>
#include <vtkStructuredGrid.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataSetWriter.h>
#include <vtkXMLMultiBlockDataWriter.h>

#include <array>
#include <cstdint>
#include <fstream>

#include "tests/support/text_meshes.hpp"

namespace cellproj::testing_support {

namespace {

namespace fs = std::filesystem;

using Prepare = std::function<fs::path(const fs::path& folder, const fs::path& real)>;

fs::path put(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
}

// ---- VTK's datasets ----

void add_fields(vtkDataSet& data) {
    vtkNew<vtkDoubleArray> scalar, vector, number;
    scalar->SetName("potential");
    vector->SetName("velocity");
    vector->SetNumberOfComponents(3);
    number->SetName("number");
    for (vtkIdType p = 0; p < data.GetNumberOfPoints(); ++p) {
        std::array<double, 3> x{};
        data.GetPoint(p, x.data());
        scalar->InsertNextValue(sample_potential({x[0], x[1], x[2]}));
        vector->InsertNextTuple(x.data());
    }
    for (vtkIdType c = 0; c < data.GetNumberOfCells(); ++c)
        number->InsertNextValue(0.5 * static_cast<double>(c));
    data.GetPointData()->AddArray(scalar);
    data.GetPointData()->AddArray(vector);
    data.GetCellData()->AddArray(number);
}

// The sample mesh, and a polyhedron (the tetrahedron once more) where a format has them.
vtkSmartPointer<vtkUnstructuredGrid> unstructured(bool polyhedron) {
    const Dataset mesh = sample_mesh();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const glm::dvec3& p : mesh.points)
        points->InsertNextPoint(p.x, p.y, p.z);
    const auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    grid->SetPoints(points);
    constexpr std::array<int, 4> types{VTK_HEXAHEDRON, VTK_PYRAMID, VTK_WEDGE, VTK_TETRA};
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        std::vector<vtkIdType> ids(
            mesh.cells.vertices.begin() + static_cast<std::ptrdiff_t>(mesh.cells.offsets[c]),
            mesh.cells.vertices.begin() + static_cast<std::ptrdiff_t>(mesh.cells.offsets[c + 1]));
        grid->InsertNextCell(types[c], static_cast<vtkIdType>(ids.size()), ids.data());
    }
    if (polyhedron) {
        constexpr std::array<vtkIdType, 17> stream{4, 3, 5, 10, 6, 3, 5, 10, 11, 3, 10, 6, 11, 3, 6, 5, 11};
        grid->InsertNextCell(VTK_POLYHEDRON, 4, stream.data() + 1);
    }
    add_fields(*grid);
    return grid;
}

constexpr std::array<int, 3> dims{5, 4, 3};

vtkSmartPointer<vtkDataSet> structured() {
    const auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
    vtkNew<vtkPoints> points;
    for (int p = 0; p < dims[0] * dims[1] * dims[2]; ++p)
        points->InsertNextPoint(p % dims[0], p / dims[0] % dims[1], p / (dims[0] * dims[1]));
    grid->SetDimensions(dims.data());
    grid->SetPoints(points);
    add_fields(*grid);
    return grid;
}

vtkSmartPointer<vtkDataSet> rectilinear() {
    const auto grid = vtkSmartPointer<vtkRectilinearGrid>::New();
    std::array<vtkNew<vtkDoubleArray>, 3> axes;
    for (std::size_t d = 0; d < 3; ++d) {
        for (int n = 0; n < dims[d]; ++n)
            axes[d]->InsertNextValue(n * n);
    }
    grid->SetDimensions(dims.data());
    grid->SetXCoordinates(axes[0]);
    grid->SetYCoordinates(axes[1]);
    grid->SetZCoordinates(axes[2]);
    add_fields(*grid);
    return grid;
}

vtkSmartPointer<vtkImageData> image() {
    const auto grid = vtkSmartPointer<vtkImageData>::New();
    grid->SetDimensions(dims.data());
    grid->SetSpacing(0.5, 1, 2);
    add_fields(*grid);
    return grid;
}

enum class Encoding { ascii, base64, appended, zlib, lz4, lzma };

void write_xml(vtkDataObject& data, const fs::path& file, Encoding encoding) {
    vtkNew<vtkXMLDataSetWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputData(&data);
    writer->SetCompressorTypeToNone();
    if (encoding == Encoding::zlib) writer->SetCompressorTypeToZLib();
    if (encoding == Encoding::lz4) writer->SetCompressorTypeToLZ4();
    if (encoding == Encoding::lzma) writer->SetCompressorTypeToLZMA();
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    if (encoding == Encoding::ascii) writer->SetDataModeToAscii();
    if (encoding == Encoding::base64) writer->SetDataModeToBinary();
    writer->Write();
}

DamageSample xml(const std::string& name, const std::string& suffix, Encoding encoding,
                 const std::function<vtkSmartPointer<vtkDataSet>()>& make) {
    const std::string file = name + suffix;
    return {name, {file}, [=](const fs::path& folder, const fs::path&) {
                write_xml(*make(), folder / file, encoding);
                return folder / file;
            }};
}

DamageSample legacy(const std::string& name, bool binary, const std::function<vtkSmartPointer<vtkDataSet>()>& make) {
    const std::string file = name + ".vtk";
    return {name, {file}, [=](const fs::path& folder, const fs::path&) {
                vtkNew<vtkDataSetWriter> writer;
                writer->SetFileName((folder / file).c_str());
                writer->SetInputData(make());
                writer->SetFileType(binary ? VTK_BINARY : VTK_ASCII);
                writer->Write();
                return folder / file;
            }};
}

// Files that name a .vtu beside them.
DamageSample index_of(const std::string& name, const std::string& suffix, const std::string& text) {
    return {name, {name + suffix, "piece.vtu"}, [=](const fs::path& folder, const fs::path&) {
                write_xml(*unstructured(false), folder / "piece.vtu", Encoding::ascii);
                return put(folder / (name + suffix), text);
            }};
}

const char* const pvtu =
    "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PUnstructuredGrid "
    "GhostLevel=\"0\">\n"
    "<PPoints><PDataArray type=\"Float64\" NumberOfComponents=\"3\"/></PPoints>\n"
    "<PPointData><PDataArray type=\"Float64\" Name=\"potential\"/></PPointData>\n"
    "<Piece Source=\"piece.vtu\"/><Piece Source=\"piece.vtu\"/>\n</PUnstructuredGrid>\n</VTKFile>\n";
const char* const vtm =
    "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" byte_order=\"LittleEndian\">\n<vtkMultiBlockDataSet>\n"
    "<DataSet index=\"0\" name=\"fluid\" file=\"piece.vtu\"/>\n<Block index=\"1\" name=\"parts\">\n"
    "<DataSet index=\"0\" file=\"piece.vtu\"/>\n</Block>\n</vtkMultiBlockDataSet>\n</VTKFile>\n";
const char* const pvd =
    "<VTKFile type=\"Collection\" version=\"0.1\"><Collection>\n<DataSet timestep=\"0\" part=\"0\" "
    "file=\"piece.vtu\"/>\n"
    "<DataSet timestep=\"0.5\" part=\"0\" file=\"piece.vtu\"/>\n</Collection></VTKFile>\n";

fs::path write_exodus(const fs::path& folder, const fs::path&) {
    const fs::path file = folder / "exodus.e";
    vtkNew<vtkExodusIIWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputData(unstructured(false));
    writer->Write();
    return file;
}

fs::path write_meta_image(const fs::path& folder, const fs::path&) {
    const fs::path file = folder / "meta.mha";
    const auto voxels = image();
    voxels->GetPointData()->SetActiveScalars("potential");
    vtkNew<vtkMetaImageWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputData(voxels);
    writer->Write();
    return file;
}

// ---- Others ----

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

fs::path write_plot3d(const fs::path& folder, const fs::path&) {
    std::string grid, solution;
    const int count = dims[0] * dims[1] * dims[2];
    for (std::string* bytes : {&grid, &solution}) {
        for (const int n : dims)
            append(*bytes, std::int32_t{n});
    }
    for (int axis = 0; axis < 3; ++axis) {
        for (int p = 0; p < count; ++p) {
            const std::array<int, 3> ijk{p % dims[0], p / dims[0] % dims[1], p / (dims[0] * dims[1])};
            append(grid, static_cast<float>(ijk[static_cast<std::size_t>(axis)]));
        }
    }
    for (const float condition : {2.0F, 0.0F, 1e6F, 0.0F})
        append(solution, condition);
    for (int value = 0; value < 5 * count; ++value)
        append(solution, 1.0F + static_cast<float>(value % count));
    put(folder / "solution.q", solution);
    return put(folder / "plot3d.xyz", grid);
}

fs::path write_nrrd(const fs::path& folder, const fs::path&) {
    std::string bytes = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 12 5 4\nspacings: 0.5 1 2\nencoding: raw\n\n";
    for (int v = 0; v < 240; ++v)
        bytes += static_cast<char>(v);
    return put(folder / "nrrd.nrrd", bytes);
}

DamageSample text(const std::string& name, const std::string& suffix, const std::string& bytes, bool surface = false) {
    DamageSample sample{name, {name + suffix}, [=](const fs::path& folder, const fs::path&) {
                            return put(folder / (name + suffix), bytes);
                        }};
    sample.surface = surface;
    return sample;
}

DamageSample two_texts(const std::string& name, const std::string& first, const std::string& first_bytes,
                       const std::string& second, const std::string& second_bytes) {
    return {name, {name + first, name + second}, [=](const fs::path& folder, const fs::path&) {
                put(folder / (name + second), second_bytes);
                return put(folder / (name + first), first_bytes);
            }};
}

DamageSample real(const std::string& name, const std::string& source, const std::string& entry,
                  const std::vector<std::string>& files, std::size_t flips_at_once) {
    DamageSample sample{name, files, [=](const fs::path& folder, const fs::path& data) {
                            const fs::path from = data / source;
                            fs::copy(from, fs::is_directory(from) ? folder : folder / from.filename(),
                                     fs::copy_options::recursive);
                            for (const auto& copied : fs::recursive_directory_iterator(folder))
                                fs::permissions(copied, fs::perms::owner_all, fs::perm_options::add);
                            return folder / entry;
                        }};
    sample.source = source;
    sample.flips_at_once = flips_at_once;
    return sample;
}

// ---- Surfaces: the boundary of a tetrahedron and a square in two triangles ----

vtkSmartPointer<vtkPolyData> polygons() {
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    for (const auto& p : {glm::dvec3(0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}})
        points->InsertNextPoint(p.x, p.y, p.z);
    data->SetPoints(points);
    data->Allocate();
    constexpr std::array<std::array<vtkIdType, 3>, 5> triangles{
        {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 4, 2}}};
    for (const auto& t : triangles)
        data->InsertNextCell(VTK_TRIANGLE, 3, t.data());
    add_fields(*data);
    return data;
}

DamageSample stl(const std::string& name, int type) {
    DamageSample sample{name, {name + ".stl"}, [=](const fs::path& folder, const fs::path&) {
                            const fs::path file = folder / (name + ".stl");
                            vtkNew<vtkSTLWriter> writer;
                            writer->SetFileName(file.c_str());
                            writer->SetInputData(polygons());
                            writer->SetFileType(type);
                            writer->Write();
                            return file;
                        }};
    sample.surface = true;
    return sample;
}

const std::string corner_points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 0\n";
const std::string corner_faces = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n3 1 4 2\n";

std::string ply(bool binary) {
    std::string bytes = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                        " 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face 5\n"
                        "property list uchar int vertex_indices\nend_header\n";
    if (!binary) return bytes + corner_points + corner_faces;
    for (const float x : {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0})
        append(bytes, x);
    for (const auto& t :
         std::array<std::array<std::int32_t, 3>, 5>{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 4, 2}}}) {
        append(bytes, std::uint8_t{3});
        append(bytes, t);
    }
    return bytes;
}

}  // namespace

std::vector<DamageSample> damage_samples() {
    const auto mixed = [] { return vtkSmartPointer<vtkDataSet>(unstructured(true)); };
    const auto linear = [] { return vtkSmartPointer<vtkDataSet>(unstructured(false)); };
    const auto voxels = [] { return vtkSmartPointer<vtkDataSet>(image()); };
    std::vector<DamageSample> samples{
        xml("VtuAscii", ".vtu", Encoding::ascii, mixed),
        xml("VtuBase64", ".vtu", Encoding::base64, mixed),
        xml("VtuAppended", ".vtu", Encoding::appended, mixed),
        xml("VtuZlib", ".vtu", Encoding::zlib, mixed),
        xml("VtuLz4", ".vtu", Encoding::lz4, mixed),
        xml("VtuLzma", ".vtu", Encoding::lzma, mixed),
        xml("Vts", ".vts", Encoding::appended, structured),
        xml("Vtr", ".vtr", Encoding::zlib, rectilinear),
        xml("Vti", ".vti", Encoding::ascii, voxels),
        index_of("Pvtu", ".pvtu", pvtu),
        index_of("Vtm", ".vtm", vtm),
        index_of("Pvd", ".pvd", pvd),
        legacy("LegacyAscii", false, linear),
        legacy("LegacyBinary", true, linear),
        legacy("LegacyStructured", true, structured),
        legacy("LegacyRectilinear", false, rectilinear),
        legacy("LegacyImage", true, voxels),
        {"Plot3d", {"plot3d.xyz", "solution.q"}, write_plot3d, "", false, "solution.q"},
        {"Exodus", {"exodus.e"}, write_exodus},
        {"MetaImage", {"meta.mha"}, write_meta_image},
        {"Nrrd", {"nrrd.nrrd"}, write_nrrd},
        text("Gmsh2Ascii", ".msh", gmsh_file(2, false, 1)),
        text("Gmsh2Binary", ".msh", gmsh_file(2, true, 1)),
        text("Gmsh4Ascii", ".msh", gmsh_file(4, false, 1)),
        text("Gmsh4Binary", ".msh", gmsh_file(4, true, 1)),
        text("Su2", ".su2", su2_file()),
        two_texts("Medit", ".mesh", medit_file(), ".sol", medit_solutions()),
        two_texts("Tetgen", ".node", tetgen_nodes(1), ".ele", tetgen_elements(1)),
        stl("StlAscii", VTK_ASCII),
        stl("StlBinary", VTK_BINARY),
        text("Off", ".off", "OFF\n5 5 0\n" + corner_points + corner_faces, true),
        text("PlyAscii", ".ply", ply(false), true),
        text("PlyBinary", ".ply", ply(true), true),
        text("Obj", ".obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 2 5 3\n", true),
        xml("Vtp", ".vtp", Encoding::zlib, [] { return vtkSmartPointer<vtkDataSet>(polygons()); }),
        real("ExodusReal", "exodus_small", "simple-cube-multi-element-order1.e", {"simple-cube-multi-element-order1.e"},
             4),
        real("NrrdGzip", "volumes/nrrd/BallBinary30x30x30_gz.nrrd", "BallBinary30x30x30_gz.nrrd",
             {"BallBinary30x30x30_gz.nrrd"}, 4),
        real("OpenFoam", "openfoam_case/64BitFloats", "case.foam",
             {"constant/polyMesh/points", "constant/polyMesh/faces", "constant/polyMesh/owner",
              "constant/polyMesh/neighbour", "0/p", "0/U"},
             1),
        real("EnSightAscii", "ensight_nfaced", "TEST.case", {"TEST.case", "test.geo"}, 4),
        real("EnSightBinary", "ensight_nfaced", "TEST_bin.case", {"TEST_bin.case", "test_bin.geo"}, 4),
        real("EnSightAsciiValues", "ensight_nfaced", "TEST.case", {"test.pressure.0001"}, 4),
        real("EnSightBinaryValues", "ensight_nfaced", "TEST_bin.case",
             {"test_bin.pressure.0001", "test_bin.velocity.0001"}, 4),
        real("CgnsAdf", "cylinder3d_cgns/cylinder3D_adf.cgns", "cylinder3D_adf.cgns", {"cylinder3D_adf.cgns"}, 10),
        real("CgnsHdf5", "cylinder3d_cgns/cylinder3D_hdf5.cgns", "cylinder3D_hdf5.cgns", {"cylinder3D_hdf5.cgns"}, 10)};
    for (DamageSample& sample : samples) {
        if (sample.name == "Vtp") sample.surface = true;
        for (const char* name :
             {"LegacyAscii", "LegacyImage", "Gmsh4Ascii", "Tetgen", "Obj", "EnSightAsciiValues", "EnSightBinaryValues"})
            sample.open_ended = sample.open_ended || sample.name == name;
    }
    return samples;
}

}  // namespace cellproj::testing_support
