// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "mesh/error.hpp"
#include "mesh/io/hidden_cells.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

std::array<int, 3> dimensions_of(vtkDataSet& grid) {
    std::array<int, 3> n{};
    if (auto* curvilinear = vtkStructuredGrid::SafeDownCast(&grid)) curvilinear->GetDimensions(n.data());
    if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(&grid)) rectilinear->GetDimensions(n.data());
    if (auto* image = vtkImageData::SafeDownCast(&grid)) image->GetDimensions(n.data());
    return n;
}

std::string to_words(const std::array<int, 3>& n) {
    return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]) + " points";
}

[[noreturn]] void fail(ErrorKind kind, const fs::path& file, const std::string& expected, const std::string& found,
                       const std::string& advice) {
    throw Error({.kind = kind, .place = file.string(), .expected = expected, .found = found, .advice = advice});
}

// The grid's dimensions, once its arrays are known to fill them.
GridDimensions require_volume(vtkDataSet& grid, const fs::path& file) {
    const std::array<int, 3> n = dimensions_of(grid);
    if (*std::min_element(n.begin(), n.end()) < 1) {
        fail(ErrorKind::format, file, "a grid of points", to_words(n), "the file is damaged: write it again");
    }
    const GridDimensions dims{static_cast<std::size_t>(n[0]), static_cast<std::size_t>(n[1]),
                              static_cast<std::size_t>(n[2])};
    if (*std::min_element(n.begin(), n.end()) < 2) {
        fail(ErrorKind::data, file, "at least 2 points in each direction", to_words(n),
             "a point, a line or a surface has no volume to draw");
    }
    constexpr std::size_t most = std::numeric_limits<VertexId>::max();
    if (dims.ni * dims.nj > most || dims.ni * dims.nj * dims.nk > max_elements) {
        fail(ErrorKind::data, file, "at most " + std::to_string(max_elements) + " points (ids have 32 bits)",
             to_words(n), "cut the grid into parts");
    }
    auto* curvilinear = vtkStructuredGrid::SafeDownCast(&grid);
    const auto* rectilinear = vtkRectilinearGrid::SafeDownCast(&grid);
    vtkIdType points = grid.GetNumberOfPoints();
    if (curvilinear) points = curvilinear->GetPoints() ? curvilinear->GetPoints()->GetNumberOfPoints() : 0;
    if (points != static_cast<vtkIdType>(dims.ni * dims.nj * dims.nk)) {
        fail(ErrorKind::format, file, to_words(n), std::to_string(points), "the file is damaged: write it again");
    }
    if (rectilinear) {
        auto* r = vtkRectilinearGrid::SafeDownCast(&grid);
        const std::array<vtkDataArray*, 3> axes{r->GetXCoordinates(), r->GetYCoordinates(), r->GetZCoordinates()};
        for (std::size_t d = 0; d < 3; ++d) {
            if (axes[d] && axes[d]->GetNumberOfTuples() == n[d]) continue;
            fail(ErrorKind::format, file, std::to_string(n[d]) + " coordinates on axis " + std::to_string(d),
                 std::to_string(axes[d] ? axes[d]->GetNumberOfTuples() : 0), "the file is damaged: write it again");
        }
    }
    return dims;
}

std::vector<glm::dvec3> points_of(vtkDataSet& grid, const fs::path& file) {
    if (auto* curvilinear = vtkStructuredGrid::SafeDownCast(&grid)) return to_points(*curvilinear->GetPoints(), file);
    std::vector<glm::dvec3> points(static_cast<std::size_t>(grid.GetNumberOfPoints()));
    for (std::size_t p = 0; p < points.size(); ++p) {
        grid.GetPoint(static_cast<vtkIdType>(p), &points[p].x);
        if (std::isfinite(points[p].x) && std::isfinite(points[p].y) && std::isfinite(points[p].z)) continue;
        fail(ErrorKind::data, file.string() + ", point " + std::to_string(p), "finite coordinates", "NaN or infinity",
             "look for the program that wrote it");
    }
    return points;
}

// The axes of a rectilinear grid or of an image that is not turned, from the points they gave.
std::optional<BoxGrid> boxes_of(vtkDataSet& grid, const GridDimensions& n, const std::vector<glm::dvec3>& points) {
    auto* image = vtkImageData::SafeDownCast(&grid);
    if (!image && !vtkRectilinearGrid::SafeDownCast(&grid)) return std::nullopt;
    if (image && !image->GetDirectionMatrix()->IsIdentity()) return std::nullopt;
    BoxGrid boxes;
    const std::array<std::size_t, 3> counts{n.ni, n.nj, n.nk}, strides{1, n.ni, n.ni * n.nj};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < counts[axis]; ++i)
            boxes.axes[axis].coordinates.push_back(points[i * strides[axis]][static_cast<int>(axis)]);
        if (image) boxes.axes[axis].spacing = image->GetSpacing()[axis];
    }
    return boxes;
}

bool is_visible(vtkDataSet& grid, vtkIdType cell) {
    if (auto* curvilinear = vtkStructuredGrid::SafeDownCast(&grid)) return curvilinear->IsCellVisible(cell) != 0;
    if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(&grid)) return rectilinear->IsCellVisible(cell) != 0;
    return vtkImageData::SafeDownCast(&grid)->IsCellVisible(cell) != 0;
}

// Leaves out the cells that are blanked or touch a blanked point; ghost copies of a neighbour's cells, too.
void leave_out_blanked(Dataset& dataset, vtkDataSet& grid) {
    if (!grid.HasAnyGhostCells() && !grid.HasAnyGhostPoints() && !grid.HasAnyBlankCells() &&
        !grid.HasAnyBlankPoints()) {
        return;
    }
    vtkUnsignedCharArray* ghosts = grid.GetCellGhostArray();
    std::vector<bool> hidden(dataset.grid->cells());
    for (std::size_t c = 0; c < hidden.size(); ++c) {
        const auto cell = static_cast<vtkIdType>(c);
        const bool copy = ghosts && (ghosts->GetValue(cell) & vtkDataSetAttributes::DUPLICATECELL) != 0;
        hidden[c] = copy || !is_visible(grid, cell);
    }
    leave_out_cells(dataset, hidden);
}

}  // namespace

bool is_structured(vtkDataObject& data) {
    return data.IsA("vtkStructuredGrid") || data.IsA("vtkRectilinearGrid") || data.IsA("vtkImageData");
}

Dataset structured_to_dataset(vtkDataSet& grid, const fs::path& file, const std::string& format) {
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = format;
    dataset.grid = require_volume(grid, file);
    dataset.points = points_of(grid, file);
    dataset.boxes = boxes_of(grid, *dataset.grid, dataset.points);
    const auto whole = [](vtkDataArray& array, const std::string& name) { return to_field(array, name); };
    dataset.point_fields = to_fields(*grid.GetPointData(), dataset.points.size(), file, whole);
    dataset.cell_fields = to_fields(*grid.GetCellData(), dataset.grid->cells(), file, whole);
    leave_out_blanked(dataset, grid);
    if (dataset.cell_count() == 0) {
        fail(ErrorKind::data, file, "volume cells", "a grid that is blanked as a whole", "check its ghost array");
    }
    return dataset;
}

}  // namespace cellproj
