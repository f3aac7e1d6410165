// SPDX-License-Identifier: BSD-3-Clause
//
// PLOT3D files (Walatka, Buning, Pierce, Elson, "PLOT3D User's Manual", NASA TM-101067, 1990) say nothing about
// themselves: no magic number, no byte order. A grid file is
//   [number of blocks,] ni nj nk per block, then x y z [IBLANK] of all points per block;
// a solution file is
//   [number of blocks,] ni nj nk per block, then Mach alpha Re time and five conserved variables per block.
// They are binary, as C or as Fortran writes them (which puts each of these groups between two 4-byte record lengths),
// or text. The layout is the one that explains the size of the grid file to the byte, or the count of its numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "mesh/error.hpp"
#include "mesh/io/file_bytes.hpp"
#include "mesh/io/hidden_cells.hpp"
#include "mesh/io/merge_blocks.hpp"
#include "mesh/io/number_file.hpp"
#include "mesh/text_formats.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

using BlockDimensions = std::array<std::uint64_t, 3>;

// All sizes and places in bytes, or in numbers where the file is text.
struct Layout {
    bool text = false;
    bool big_endian = true;
    bool records = false;      // Fortran record lengths around each group
    bool block_count = false;  // the file starts with the number of blocks
    NumberType real = NumberType::float32;
    bool iblank = false;

    std::uint64_t integer_size() const { return text ? 1 : 4; }
    std::uint64_t real_size() const { return text ? 1 : bytes_of(real); }
    std::uint64_t mark() const { return records ? 4 : 0; }  // a record length
    std::uint64_t header_size(std::size_t blocks) const {
        const std::uint64_t count = block_count ? integer_size() + 2 * mark() : 0;
        return count + 3 * integer_size() * blocks + 2 * mark();
    }
};

std::string to_words(const BlockDimensions& dims) {
    return std::to_string(dims[0]) + " x " + std::to_string(dims[1]) + " x " + std::to_string(dims[2]);
}

std::string size_in_words(const NumberFile& file) {
    return std::to_string(file.size()) + (file.is_text() ? " numbers" : " bytes");
}

std::uint64_t points_in(const BlockDimensions& dims) {
    return dims[0] * dims[1] * dims[2];
}

// Numbers one after the other.
class Cursor {
public:
    Cursor(const NumberFile& file, const Layout& layout, std::uint64_t place)
        : file_(file), layout_(layout), place_(place) {}

    double integer() {
        const double value = file_.at(place_, NumberType::int32, layout_.big_endian);
        place_ += layout_.integer_size();
        return value;
    }
    double real() {
        const double value = file_.at(place_, layout_.real, layout_.big_endian);
        place_ += layout_.real_size();
        return value;
    }
    void skip(std::uint64_t size) { place_ += size; }
    void pass_mark() { place_ += layout_.mark(); }

private:
    const NumberFile& file_;
    const Layout& layout_;
    std::uint64_t place_;
};

// ---- The layout ----

// A file could not hold that many points, one unit each; also keeps every later product below 2^63.
bool plausible(const std::array<double, 3>& dims, std::uint64_t size) {
    auto room = static_cast<double>(size);
    for (const double n : dims) {
        if (!(n >= 1.0 && n <= room) || n != std::floor(n)) return false;
        room /= n;
    }
    return true;
}

// The header both kinds of file share, as `layout` reads it; none when it makes no sense.
std::optional<std::vector<BlockDimensions>> read_header(const NumberFile& file, const Layout& layout) {
    constexpr double most_blocks = 100000;
    const std::uint64_t size = file.size();
    Cursor cursor(file, layout, 0);
    // Throws nothing away but what cannot be: a length must be that of its record.
    const auto begins_record = [&](double length) { return !layout.records || cursor.integer() == length; };

    double blocks = 1;
    if (layout.block_count) {
        if (size < layout.integer_size() + 2 * layout.mark() || !begins_record(4)) return std::nullopt;
        blocks = cursor.integer();
        if (!(blocks >= 1 && blocks <= most_blocks) || blocks != std::floor(blocks)) return std::nullopt;
        cursor.pass_mark();
    }
    if (size < layout.header_size(static_cast<std::size_t>(blocks)) || !begins_record(12 * blocks)) return std::nullopt;
    std::vector<BlockDimensions> all(static_cast<std::size_t>(blocks));
    for (BlockDimensions& block : all) {
        const double ni = cursor.integer(), nj = cursor.integer(), nk = cursor.integer();
        if (!plausible({ni, nj, nk}, size)) return std::nullopt;
        block = {static_cast<std::uint64_t>(ni), static_cast<std::uint64_t>(nj), static_cast<std::uint64_t>(nk)};
    }
    return all;
}

// Of one block in a grid file, without record lengths and with them.
std::uint64_t grid_size(const Layout& layout, const BlockDimensions& dims) {
    return points_in(dims) * (3 * layout.real_size() + (layout.iblank ? layout.integer_size() : 0)) + 2 * layout.mark();
}

std::uint64_t solution_size(const Layout& layout, const BlockDimensions& dims) {
    return (4 + 5 * points_in(dims)) * layout.real_size() + 4 * layout.mark();
}

std::uint64_t whole_size(const Layout& layout, const std::vector<BlockDimensions>& blocks,
                         std::uint64_t (*block_size)(const Layout&, const BlockDimensions&)) {
    std::uint64_t size = layout.header_size(blocks.size());
    for (const BlockDimensions& dims : blocks)
        size += block_size(layout, dims);
    return size;
}

std::vector<Layout> all_layouts(bool text) {
    std::vector<Layout> layouts;
    for (const bool iblank : {false, true}) {
        for (const NumberType real : {NumberType::float32, NumberType::float64}) {
            for (const bool block_count : {false, true}) {
                for (const bool records : {false, true}) {
                    for (const bool big_endian : {true, false}) {
                        const bool binary_only = records || !big_endian || real == NumberType::float64;
                        if (text && binary_only) continue;
                        layouts.push_back({text, big_endian, records, block_count, real, iblank});
                    }
                }
            }
        }
    }
    return layouts;
}

struct Grid {
    Layout layout;
    std::vector<BlockDimensions> blocks;
};

// What the headers say under each layout that can read them, for the message.
std::string describe_attempts(const std::vector<Grid>& attempts) {
    std::string text;
    for (const auto& [layout, blocks] : attempts) {
        if (blocks.size() != 1 || layout.iblank) continue;
        text += (text.empty() ? ", which starts like a grid of " : " or ") + to_words(blocks[0]) + " (" +
                std::to_string(whole_size(layout, blocks, grid_size)) +
                (layout.text ? " numbers)" : " bytes at " + std::to_string(8 * layout.real_size()) + " bits)");
    }
    return text;
}

Grid recognise_grid(const NumberFile& numbers, const fs::path& file) {
    std::vector<Grid> attempts;
    for (const Layout& layout : all_layouts(numbers.is_text())) {
        const auto blocks = read_header(numbers, layout);
        if (!blocks) continue;
        attempts.push_back({layout, *blocks});
        if (whole_size(layout, *blocks, grid_size) == numbers.size()) return attempts.back();
    }
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a PLOT3D grid, whose header fits the file's size exactly",
                 .found = size_in_words(numbers) + describe_attempts(attempts),
                 .advice = "the file may be cut off, or no PLOT3D grid: write it again or convert it to .vtu"});
}

// ---- What the user asked for ----

bool is_volume(const BlockDimensions& dims) {
    return *std::min_element(dims.begin(), dims.end()) >= 2;
}

std::string block_name(std::size_t block) {
    return "block " + std::to_string(block + 1);
}

std::vector<std::string> volume_names(const Grid& grid) {
    std::vector<std::string> names;
    for (std::size_t b = 0; b < grid.blocks.size(); ++b) {
        if (is_volume(grid.blocks[b])) names.push_back(block_name(b));
    }
    return names;
}

[[noreturn]] void fail(ErrorKind kind, const fs::path& file, const std::string& expected, const std::string& found,
                       const std::string& advice) {
    throw Error({.kind = kind, .place = file.string(), .expected = expected, .found = found, .advice = advice});
}

void require_volumes(const Grid& grid, const fs::path& file) {
    for (const BlockDimensions& dims : grid.blocks) {
        if (points_in(dims) <= max_elements) continue;
        fail(ErrorKind::data, file, "at most " + std::to_string(max_elements) + " points (ids have 32 bits)",
             to_words(dims), "cut the grid into parts");
    }
    if (std::any_of(grid.blocks.begin(), grid.blocks.end(), is_volume)) return;
    fail(ErrorKind::data, file, "at least 2 points in each direction",
         to_words(grid.blocks[0]) +
             (grid.blocks.size() > 1 ? " and " + std::to_string(grid.blocks.size() - 1) + " more without" : ""),
         "a surface has no volume to draw");
}

// Trailing bytes are common and harmless, as long as they could not be a sixth variable: then it is another format
// (OVERFLOW).
void require_matching_solution(const Grid& grid, const NumberFile& numbers, const fs::path& file) {
    const auto blocks = numbers.is_text() == grid.layout.text ? read_header(numbers, grid.layout) : std::nullopt;
    if (!blocks) {
        fail(ErrorKind::format, file, "a PLOT3D solution written as its grid was", "no such header",
             "give the solution (Q) file in the grid's byte order and record form");
    }
    if (*blocks != grid.blocks) {
        const std::size_t known = std::min(blocks->size(), grid.blocks.size());
        const auto [own, other] =
            std::mismatch(blocks->begin(), blocks->begin() + static_cast<std::ptrdiff_t>(known), grid.blocks.begin());
        const auto block = static_cast<std::size_t>(own - blocks->begin());
        fail(ErrorKind::data, file,
             block < known ? "a solution for the grid's " + to_words(*other) + " points" +
                                 (known > 1 ? " of " + block_name(block) : "")
                           : "a solution for the grid's " + std::to_string(grid.blocks.size()) + " blocks",
             block < known ? "one for " + to_words(*own) : std::to_string(blocks->size()) + " blocks",
             "give the solution that belongs to this grid");
    }
    const std::uint64_t needed = whole_size(grid.layout, grid.blocks, solution_size);
    std::uint64_t points = 0;
    for (const BlockDimensions& dims : grid.blocks)
        points += points_in(dims);
    if (numbers.size() < needed || numbers.size() - needed >= points * grid.layout.real_size()) {
        fail(ErrorKind::format, file,
             "five variables, " + std::to_string(needed) + (numbers.is_text() ? " numbers" : " bytes"),
             size_in_words(numbers),
             numbers.size() < needed ? "the file is cut off: write or copy it again"
                                     : "write a plain PLOT3D solution (Q) file");
    }
}

// ---- The blocks ----

void read_points(Cursor cursor, const Layout& layout, const fs::path& place, Dataset& dataset) {
    const std::size_t count = dataset.points.size();
    cursor.pass_mark();
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t p = 0; p < count; ++p)
            dataset.points[p][axis] = cursor.real();
    }
    // IBLANK 0 marks holes, where points and values mean nothing; 1 is the field, 2 and more are walls and other
    // conditions, negative numbers are points interpolated from the block of that number: all of these hold values.
    std::vector<bool> holes(count, false);
    for (std::size_t p = 0; layout.iblank && p < count; ++p)
        holes[p] = cursor.integer() == 0.0;
    for (std::size_t p = 0; p < count; ++p) {
        const glm::dvec3& x = dataset.points[p];
        if (holes[p] || (std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z))) continue;
        throw Error({.kind = ErrorKind::data,
                     .place = place.string() + ", point " + std::to_string(p),
                     .expected = "finite coordinates",
                     .found = "(" + std::to_string(x.x) + ", " + std::to_string(x.y) + ", " + std::to_string(x.z) + ")",
                     .advice = "look for the program that wrote it: no cell can be drawn there"});
    }
    leave_out_cells(dataset, cells_touching(*dataset.grid, holes));
}

// What is stored, and what follows from it for an ideal gas of gamma 1.4 (PLOT3D's functions 110, 112 and 153).
std::vector<Field> read_solution(Cursor cursor, const Layout& layout, std::size_t points) {
    constexpr double gamma = 1.4;
    cursor.pass_mark();
    cursor.skip(4 * layout.real_size());  // free-stream Mach number, angle of attack, Reynolds number, time
    cursor.pass_mark();
    cursor.pass_mark();
    std::array<Field, 6> fields{Field{"Density", 1, {}},  Field{"Momentum", 3, {}}, Field{"StagnationEnergy", 1, {}},
                                Field{"Pressure", 1, {}}, Field{"Mach", 1, {}},     Field{"VelocityMagnitude", 1, {}}};
    auto& [density, momentum, energy, pressure, mach, speed] = fields;
    for (Field& field : fields)
        field.values.resize(points * static_cast<std::size_t>(field.components));
    for (double& value : density.values)
        value = cursor.real();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t p = 0; p < points; ++p)
            momentum.values[3 * p + axis] = cursor.real();
    }
    for (double& value : energy.values)
        value = cursor.real();
    for (std::size_t p = 0; p < points; ++p) {
        const double rho = density.values[p];
        const double* const m = &momentum.values[3 * p];
        const double v = std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]) / rho;
        speed.values[p] = v;
        pressure.values[p] = (gamma - 1.0) * (energy.values[p] - 0.5 * rho * v * v);
        // Without a real speed of sound there is no Mach number, at rest neither.
        const double sound_squared = gamma * pressure.values[p] / rho;
        mach.values[p] = sound_squared > 0.0 ? v / std::sqrt(sound_squared) : std::numeric_limits<double>::quiet_NaN();
    }
    return {std::make_move_iterator(fields.begin()), std::make_move_iterator(fields.end())};
}

struct Sources {
    const NumberFile& grid;
    const NumberFile* solution;  // null: none
};

// All blocks that are chosen and have cells left.
std::vector<Dataset> read_blocks(const Grid& grid, const Sources& sources, const fs::path& file,
                                 const std::vector<std::string>& wanted) {
    const Layout& layout = grid.layout;
    const bool several = grid.blocks.size() > 1;
    std::vector<Dataset> datasets;
    std::uint64_t grid_place = layout.header_size(grid.blocks.size());
    std::uint64_t solution_place = grid_place;
    for (std::size_t b = 0; b < grid.blocks.size(); ++b) {
        const BlockDimensions& dims = grid.blocks[b];
        const Cursor grid_cursor(sources.grid, layout, std::exchange(grid_place, grid_place + grid_size(layout, dims)));
        const std::uint64_t own = std::exchange(solution_place, solution_place + solution_size(layout, dims));
        if (!is_volume(dims) || (several && !is_chosen(block_name(b), wanted))) continue;
        Dataset dataset;
        dataset.source = file.string();
        dataset.format = layout.text ? "PLOT3D curvilinear grid, text" : "PLOT3D curvilinear grid";
        dataset.grid = GridDimensions{dims[0], dims[1], dims[2]};
        dataset.points.resize(points_in(dims));
        if (sources.solution) {
            dataset.point_fields = read_solution(Cursor(*sources.solution, layout, own), layout, points_in(dims));
        }
        read_points(grid_cursor, layout, fs::path(file.string() + (several ? ", " + block_name(b) : "")), dataset);
        if (dataset.cell_count() > 0) datasets.push_back(std::move(dataset));
    }
    if (datasets.empty()) {
        fail(ErrorKind::data, file, "volume cells", "a grid that is blanked as a whole (IBLANK 0)",
             "check IBLANK in the program that wrote it");
    }
    return datasets;
}

}  // namespace

Dataset read_plot3d(const fs::path& file, const fs::path& solution, const std::vector<std::string>& wanted) {
    const NumberFile numbers(file);
    const Grid grid = recognise_grid(numbers, file);
    require_volumes(grid, file);
    std::vector<std::string> names;
    if (grid.blocks.size() > 1) {
        names = volume_names(grid);
        require_known_blocks(wanted, names, file);
    }
    std::optional<NumberFile> values;
    if (!solution.empty()) {
        values.emplace(solution);
        require_matching_solution(grid, *values, solution);
    }
    Dataset dataset = merge_blocks(read_blocks(grid, {numbers, values ? &*values : nullptr}, file, wanted), file);
    dataset.skipped_blocks = names.empty() ? 0 : grid.blocks.size() - names.size();
    dataset.blocks = std::move(names);
    return dataset;
}

}  // namespace cellproj
