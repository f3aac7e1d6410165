// SPDX-License-Identifier: BSD-3-Clause
//
// PLOT3D files (Walatka, Buning, Pierce, Elson, "PLOT3D User's Manual", NASA TM-101067, 1990) say nothing about
// themselves: no magic number, no byte order. A grid file is
//   [number of blocks,] ni nj nk per block, then x y z [IBLANK] of all points per block;
// a solution file is
//   [number of blocks,] ni nj nk per block, then Mach alpha Re time and five conserved variables per block.
// Written by Fortran, each of these groups is a record between two 4-byte lengths. The layout is the one that explains
// the size of the grid file to the byte; only then is VTK's reader let loose on it.
#include <vtkDataArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkMultiBlockPLOT3DReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStructuredGrid.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include "mesh/error.hpp"
#include "mesh/vtk_conversion.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

using BlockDimensions = std::array<std::uint64_t, 3>;

struct Layout {
    bool big_endian = true;
    bool records = false;      // Fortran record lengths around each group
    bool block_count = false;  // the file starts with the number of blocks
    std::uint64_t real_bytes = 4;
    bool iblank = false;

    std::uint64_t record_overhead() const { return records ? 8 : 0; }
    std::uint64_t first_group_bytes() const { return block_count ? 4 + record_overhead() : 0; }
};

std::string to_words(const BlockDimensions& dims) {
    return std::to_string(dims[0]) + " x " + std::to_string(dims[1]) + " x " + std::to_string(dims[2]);
}

std::uint64_t points_in(const BlockDimensions& dims) {
    return dims[0] * dims[1] * dims[2];
}

// The 4-byte integer at `offset`, zero-extended: negative counts become too large and are refused as such.
std::uint64_t integer_at(const std::string& bytes, std::uint64_t offset, bool big_endian) {
    std::array<unsigned char, 4> b{};
    std::memcpy(b.data(), bytes.data() + offset, b.size());
    if (big_endian) std::reverse(b.begin(), b.end());
    return b[0] | b[1] << 8U | b[2] << 16U | std::uint64_t{b[3]} << 24U;
}

// A file could not hold that many points, one byte each; also keeps every later product below 2^63.
bool plausible(const BlockDimensions& dims, std::uint64_t file_size) {
    std::uint64_t room = file_size;
    for (const std::uint64_t n : dims) {
        if (n == 0 || n > room) return false;
        room /= n;
    }
    return true;
}

// The header both kinds of file share, as `layout` reads it; none when it makes no sense.
std::optional<std::vector<BlockDimensions>> read_header(const fs::path& file, const Layout& layout) {
    constexpr std::uint64_t most_blocks = 100000;
    const std::uint64_t mark = layout.records ? 4 : 0;
    const std::uint64_t size = fs::file_size(file);

    std::uint64_t blocks = 1;
    if (layout.block_count) {
        const std::string bytes = read_bytes(file, 0, layout.first_group_bytes());
        if (bytes.size() < layout.first_group_bytes()) return std::nullopt;
        if (layout.records && integer_at(bytes, 0, layout.big_endian) != 4) return std::nullopt;
        blocks = integer_at(bytes, mark, layout.big_endian);
        if (blocks == 0 || blocks > most_blocks) return std::nullopt;
    }
    const std::uint64_t group = 12 * blocks + layout.record_overhead();
    const std::string bytes = read_bytes(file, layout.first_group_bytes(), group);
    if (bytes.size() < group) return std::nullopt;
    if (layout.records && integer_at(bytes, 0, layout.big_endian) != 12 * blocks) return std::nullopt;

    std::vector<BlockDimensions> all(blocks);
    for (std::uint64_t b = 0; b < blocks; ++b) {
        for (std::uint64_t d = 0; d < 3; ++d) {
            all[b][d] = integer_at(bytes, mark + 12 * b + 4 * d, layout.big_endian);
        }
        if (!plausible(all[b], size)) return std::nullopt;
    }
    return all;
}

std::uint64_t header_bytes(const Layout& layout, std::size_t blocks) {
    return layout.first_group_bytes() + 12 * blocks + layout.record_overhead();
}

std::uint64_t grid_bytes(const Layout& layout, const std::vector<BlockDimensions>& blocks) {
    std::uint64_t bytes = header_bytes(layout, blocks.size());
    for (const BlockDimensions& dims : blocks) {
        bytes += points_in(dims) * (3 * layout.real_bytes + (layout.iblank ? 4 : 0)) + layout.record_overhead();
    }
    return bytes;
}

std::uint64_t solution_bytes(const Layout& layout, const BlockDimensions& dims) {
    return header_bytes(layout, 1) + (4 + 5 * points_in(dims)) * layout.real_bytes + 2 * layout.record_overhead();
}

std::vector<Layout> all_layouts() {
    std::vector<Layout> layouts;
    for (const bool iblank : {false, true}) {
        for (const std::uint64_t real_bytes : {4U, 8U}) {
            for (const bool block_count : {false, true}) {
                for (const bool records : {false, true}) {
                    for (const bool big_endian : {true, false}) {
                        layouts.push_back({big_endian, records, block_count, real_bytes, iblank});
                    }
                }
            }
        }
    }
    return layouts;
}

struct GridFile {
    Layout layout;
    std::vector<BlockDimensions> blocks;
};

// What the headers say under each layout that can read them, for the message.
std::string describe_attempts(const std::vector<GridFile>& attempts) {
    std::string text;
    for (const auto& [layout, blocks] : attempts) {
        if (blocks.size() != 1 || layout.iblank) continue;
        text += (text.empty() ? ", which starts like a grid of " : " or ") + to_words(blocks[0]) + " (" +
                std::to_string(grid_bytes(layout, blocks)) + " bytes at " + std::to_string(8 * layout.real_bytes) +
                " bits)";
    }
    return text;
}

GridFile recognise_grid(const fs::path& file) {
    const std::uint64_t size = fs::file_size(file);
    std::vector<GridFile> attempts;
    for (const Layout& layout : all_layouts()) {
        const auto blocks = read_header(file, layout);
        if (!blocks) continue;
        attempts.push_back({layout, *blocks});
        if (grid_bytes(layout, *blocks) == size) return attempts.back();
    }
    throw Error(
        {.kind = ErrorKind::format,
         .place = file.string(),
         .expected = "a binary PLOT3D grid, whose header fits the file's size exactly",
         .found = std::to_string(size) + " bytes" + describe_attempts(attempts),
         .advice = "the file may be cut off, a text file, or no PLOT3D grid: write it again or convert it to .vtu"});
}

void require_single_volume(const GridFile& grid, const fs::path& file) {
    const auto fail = [&](const std::string& expected, const std::string& found, const std::string& advice) {
        throw Error(
            {.kind = ErrorKind::data, .place = file.string(), .expected = expected, .found = found, .advice = advice});
    };
    if (grid.blocks.size() > 1) {
        fail("a PLOT3D grid of a single block", std::to_string(grid.blocks.size()) + " blocks",
             "write each block to its own file");
    }
    const BlockDimensions& dims = grid.blocks[0];
    if (*std::min_element(dims.begin(), dims.end()) < 2) {
        fail("at least 2 points in each direction", to_words(dims), "a surface has no volume to draw");
    }
    if (points_in(dims) > max_elements) {
        fail("at most " + std::to_string(max_elements) + " points (ids have 32 bits)", to_words(dims),
             "cut the grid into parts");
    }
}

// Trailing bytes are common and harmless, as long as they could not be a sixth variable: then it is another format
// (OVERFLOW).
void require_matching_solution(const GridFile& grid, const fs::path& file) {
    const auto fail = [&](ErrorKind kind, const std::string& expected, const std::string& found,
                          const std::string& advice) {
        throw Error({.kind = kind, .place = file.string(), .expected = expected, .found = found, .advice = advice});
    };
    const BlockDimensions& dims = grid.blocks[0];
    const auto blocks = read_header(file, grid.layout);
    if (!blocks) {
        fail(ErrorKind::format, "a PLOT3D solution written as its grid was", "no such header",
             "give the solution (Q) file in the grid's byte order and record form");
    }
    if (blocks->size() != 1 || blocks->front() != dims) {
        fail(ErrorKind::data, "a solution for the grid's " + to_words(dims) + " points",
             blocks->size() == 1 ? "one for " + to_words(blocks->front()) : std::to_string(blocks->size()) + " blocks",
             "give the solution that belongs to this grid");
    }
    const std::uint64_t size = fs::file_size(file);
    const std::uint64_t needed = solution_bytes(grid.layout, dims);
    const std::uint64_t variable = points_in(dims) * grid.layout.real_bytes;
    if (size < needed || size - needed >= variable) {
        fail(ErrorKind::format, "five variables, " + std::to_string(needed) + " bytes", std::to_string(size) + " bytes",
             size < needed ? "the file is cut off: write or copy it again" : "write a plain PLOT3D solution (Q) file");
    }
}

struct Function {
    int number;  // of vtkMultiBlockPLOT3DReader; 0: read always
    const char* vtk_name;
    const char* name;
};

constexpr std::array<Function, 6> functions{{{0, "Density", "Density"},
                                             {0, "Momentum", "Momentum"},
                                             {0, "StagnationEnergy", "StagnationEnergy"},
                                             {110, "Pressure", "Pressure"},
                                             {112, "MachNumber", "Mach"},
                                             {153, "VelocityMagnitude", "VelocityMagnitude"}}};

void configure(vtkMultiBlockPLOT3DReader& reader, const Layout& layout) {
    reader.AutoDetectFormatOff();
    reader.BinaryFileOn();
    if (layout.big_endian) {
        reader.SetByteOrderToBigEndian();
    } else {
        reader.SetByteOrderToLittleEndian();
    }
    reader.SetHasByteCount(layout.records);
    reader.SetMultiGrid(layout.block_count);
    reader.SetDoublePrecision(layout.real_bytes == 8);
    reader.SetIBlanking(layout.iblank);
    for (const Function& function : functions) {
        if (function.number != 0) reader.AddFunction(function.number);
    }
}

vtkStructuredGrid& single_block(vtkMultiBlockPLOT3DReader& reader, const BlockDimensions& dims, const fs::path& file) {
    vtkMultiBlockDataSet* blocks = reader.GetOutput();
    auto* grid = blocks->GetNumberOfBlocks() == 1 ? vtkStructuredGrid::SafeDownCast(blocks->GetBlock(0)) : nullptr;
    const auto points = static_cast<vtkIdType>(points_in(dims));
    if (!grid || !grid->GetPoints() || grid->GetNumberOfPoints() != points) {
        throw Error({.kind = ErrorKind::format,
                     .place = file.string(),
                     .expected = "a grid of " + to_words(dims) + " points",
                     .found = "that VTK's reader gave no such block",
                     .advice = "the file may be damaged: write it again"});
    }
    return *grid;
}

// IBLANK 0 marks holes of the grid, where points and values mean nothing.
void require_no_holes(vtkPointData& arrays, const fs::path& file) {
    vtkDataArray* iblank = arrays.GetArray("IBlank");
    if (!iblank) return;
    vtkIdType holes = 0;
    for (vtkIdType p = 0; p < iblank->GetNumberOfTuples(); ++p)
        holes += iblank->GetTuple1(p) == 0.0 ? 1 : 0;
    if (holes == 0) return;
    throw Error({.kind = ErrorKind::data,
                 .place = file.string(),
                 .expected = "a grid without holes",
                 .found = std::to_string(holes) + " blanked points (IBLANK 0)",
                 .advice = "convert it to a .vtu file that leaves the blanked cells out"});
}

std::vector<Field> solution_fields(vtkPointData& arrays, vtkIdType points, const fs::path& file) {
    std::vector<Field> fields;
    for (const Function& function : functions) {
        vtkDataArray* array = arrays.GetArray(function.vtk_name);
        if (!array || array->GetNumberOfTuples() != points) {
            throw Error({.kind = ErrorKind::format,
                         .place = file.string(),
                         .expected = std::string("the field ") + function.name,
                         .found = "that VTK's reader gave none of that size",
                         .advice = "the file may be damaged: write it again"});
        }
        fields.push_back(to_field(*array, function.name));
    }
    return fields;
}

}  // namespace

Dataset read_plot3d(const fs::path& file, const fs::path& solution) {
    const GridFile grid_file = recognise_grid(file);
    require_single_volume(grid_file, file);
    if (!solution.empty()) {
        require_readable(solution);
        require_matching_solution(grid_file, solution);
    }
    vtkNew<vtkMultiBlockPLOT3DReader> reader;
    configure(*reader, grid_file.layout);
    reader->SetXYZFileName(file.c_str());
    if (!solution.empty()) reader->SetQFileName(solution.c_str());
    update(*reader, file);

    const BlockDimensions& dims = grid_file.blocks[0];
    vtkStructuredGrid& grid = single_block(*reader, dims, file);
    require_no_holes(*grid.GetPointData(), file);
    Dataset dataset;
    dataset.source = file.string();
    dataset.format = "PLOT3D curvilinear grid";
    dataset.points = to_points(*grid.GetPoints(), file);
    dataset.grid = GridDimensions{dims[0], dims[1], dims[2]};
    if (!solution.empty()) {
        dataset.point_fields = solution_fields(*grid.GetPointData(), grid.GetNumberOfPoints(), solution);
    }
    return dataset;
}

}  // namespace cellproj
