// SPDX-License-Identifier: BSD-3-Clause
#include <vtkDataSet.h>
#include <vtkDataSetReader.h>
#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "mesh/error.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// The word behind DATASET, in upper case; empty when there is none. Lines: version, title (any text), ASCII or BINARY.
std::string legacy_dataset_type(const fs::path& file) {
    constexpr std::size_t head_size = 4096;
    const std::string head = read_bytes(file, 0, head_size);
    std::string upper = head.substr(std::min(head.find('\n'), head.size()));
    upper.erase(0, std::min(upper.find('\n', 1), upper.size()));
    std::transform(upper.begin(), upper.end(), upper.begin(), [](unsigned char c) { return std::toupper(c); });
    const std::size_t keyword = upper.find("DATASET");
    if (keyword == std::string::npos) return "";
    const std::size_t word = std::min(upper.find_first_not_of(" \t", keyword + 7), upper.size());
    return upper.substr(word, upper.find_first_of(" \t\r\n", word) - word);
}

struct LegacyType {
    const char* keyword;
    const char* words;
};

constexpr std::array<LegacyType, 4> supported{{{"UNSTRUCTURED_GRID", "VTK legacy unstructured grid"},
                                               {"STRUCTURED_GRID", "VTK legacy structured grid"},
                                               {"RECTILINEAR_GRID", "VTK legacy rectilinear grid"},
                                               {"STRUCTURED_POINTS", "VTK legacy image"}}};

std::string require_supported(const std::string& found, const fs::path& file) {
    const auto* type = std::find_if(supported.begin(), supported.end(),
                                    [&](const LegacyType& known) { return found == known.keyword; });
    if (type != supported.end()) return type->words;
    throw Error(
        {.kind = ErrorKind::format,
         .place = file.string(),
         .expected = "the dataset type UNSTRUCTURED_GRID, STRUCTURED_GRID, RECTILINEAR_GRID or STRUCTURED_POINTS",
         .found = found.empty() ? "a VTK file that names no dataset type" : "the type " + printable(found),
         .advice = "convert the file to one of these; fill a closed surface with tetrahedra first: cellproj "
                   "tetrahedralize"});
}

}  // namespace

Dataset read_vtk_legacy(const fs::path& file, const ReadOptions& options) {
    const std::string type = legacy_dataset_type(file);
    const std::string format = require_supported(type, file);
    if (type == "UNSTRUCTURED_GRID") require_sound_legacy_cells(file);
    vtkNew<vtkDataSetReader> reader;
    reader->SetFileName(file.c_str());
    // Without these, only the first array of each attribute is read.
    reader->ReadAllScalarsOn();
    reader->ReadAllVectorsOn();
    reader->ReadAllNormalsOn();
    reader->ReadAllTensorsOn();
    reader->ReadAllColorScalarsOn();
    reader->ReadAllTCoordsOn();
    reader->ReadAllFieldsOn();
    update(*reader, file);
    if (vtkDataObject* data = reader->GetOutputDataObject(0)) return blocks_to_dataset(*data, file, format, options);
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "the dataset that the file names",
                 .found = "that VTK's reader gave none",
                 .advice = "the file may be damaged: write it again"});
}

}  // namespace cellproj
