// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/write_vtu.hpp"

#include <unistd.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

void add_fields(vtkDataSetAttributes& attributes, const std::vector<Field>& fields) {
    for (const Field& field : fields) {
        vtkNew<vtkDoubleArray> array;
        array->SetName(field.name.c_str());
        array->SetNumberOfComponents(field.components);
        array->SetNumberOfTuples(static_cast<vtkIdType>(field.values.size()) / field.components);
        std::copy(field.values.begin(), field.values.end(), array->GetPointer(0));
        attributes.AddArray(array);
    }
    if (!fields.empty() && fields.front().components == 1) attributes.SetActiveScalars(fields.front().name.c_str());
}

vtkNew<vtkPoints> to_vtk(const std::vector<glm::dvec3>& positions) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(static_cast<vtkIdType>(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i)
        points->SetPoint(static_cast<vtkIdType>(i), &positions[i].x);
    return points;
}

vtkNew<vtkUnstructuredGrid> to_vtk(const TetMesh& mesh) {
    vtkNew<vtkCellArray> cells;
    cells->AllocateExact(static_cast<vtkIdType>(mesh.tets.size()), static_cast<vtkIdType>(4 * mesh.tets.size()));
    for (const auto& tet : mesh.tets)
        cells->InsertNextCell({vtkIdType{tet[0]}, vtkIdType{tet[1]}, vtkIdType{tet[2]}, vtkIdType{tet[3]}});
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(to_vtk(mesh.points));
    grid->SetCells(VTK_TETRA, cells);
    add_fields(*grid->GetPointData(), mesh.point_fields);
    add_fields(*grid->GetCellData(), mesh.cell_fields);
    return grid;
}

vtkNew<vtkPolyData> to_vtk(const Surface& surface, const std::vector<Field>& polygon_fields) {
    vtkNew<vtkCellArray> polygons;
    for (const std::vector<VertexId>& polygon : surface.polygons) {
        polygons->InsertNextCell(static_cast<int>(polygon.size()));
        for (const VertexId v : polygon)
            polygons->InsertCellPoint(vtkIdType{v});
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(to_vtk(surface.points));
    data->SetPolys(polygons);
    add_fields(*data->GetPointData(), surface.point_fields);
    add_fields(*data->GetCellData(), polygon_fields);
    return data;
}

[[noreturn]] void fail(const fs::path& file, const std::string& found) {
    throw Error({.kind = ErrorKind::file,
                 .place = file.string(),
                 .expected = "a place to write a file",
                 .found = found,
                 .advice = "check the folder, its permissions and the space on the disk"});
}

// Gone unless it was renamed.
class TemporaryFile {
public:
    explicit TemporaryFile(const fs::path& final_name)
        : path_(final_name.parent_path() / ("." + final_name.filename().string() + "." + std::to_string(getpid()))) {}
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }

    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

// Through memory: VTK tells what goes wrong with a file to the terminal, not to its caller.
std::string bytes_of(vtkXMLWriter& writer, vtkDataObject& data, const fs::path& file) {
    writer.SetInputDataObject(&data);
    writer.SetDataModeToAppended();
    writer.EncodeAppendedDataOff();
    writer.SetCompressorTypeToZLib();
    writer.WriteToOutputStringOn();
    if (writer.Write() != 1) fail(file, "that VTK could not write the data");
    return writer.GetOutputString();
}

void write_whole(const std::string& bytes, const fs::path& file) {
    const TemporaryFile temporary(file);
    errno = 0;
    std::ofstream stream(temporary.path(), std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) fail(file, errno != 0 ? std::strerror(errno) : "that writing failed");
    std::error_code error;
    fs::rename(temporary.path(), file, error);
    if (error) fail(file, error.message());
}

}  // namespace

void write_vtu(const TetMesh& mesh, const fs::path& file) {
    const vtkNew<vtkXMLUnstructuredGridWriter> writer;
    write_whole(bytes_of(*writer, *to_vtk(mesh), file), file);
}

void write_vtp(const Surface& surface, const std::vector<Field>& polygon_fields, const fs::path& file) {
    const vtkNew<vtkXMLPolyDataWriter> writer;
    write_whole(bytes_of(*writer, *to_vtk(surface, polygon_fields), file), file);
}

}  // namespace cellproj
