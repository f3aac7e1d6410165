// SPDX-License-Identifier: BSD-3-Clause
#include <vtkCompositeDataSet.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLGenericDataObjectReader.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>
#include <utility>

#include "mesh/error.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t head_size = 4096;

// The value of the attribute `type` of the element <VTKFile …>; empty when it has none.
std::string xml_dataset_type(const fs::path& file) {
    const std::string head = read_bytes(file, 0, head_size);
    const std::size_t from = head.find("<VTKFile");
    if (from == std::string::npos) return "";
    std::string element = head.substr(from, head.find('>', from) - from);
    std::replace_if(
        element.begin(), element.end(), [](unsigned char c) { return std::isspace(c) != 0; }, ' ');
    const std::size_t name = element.find(" type=");  // the blank keeps header_type out
    if (name == std::string::npos || name + 6 >= element.size()) return "";
    const std::size_t value = name + 7;
    return element.substr(value, element.find(element[name + 6], value) - value);
}

struct XmlType {
    const char* type;
    const char* words;
};

constexpr std::array<XmlType, 14> supported{{{"UnstructuredGrid", "VTK XML unstructured grid"},
                                             {"StructuredGrid", "VTK XML structured grid"},
                                             {"RectilinearGrid", "VTK XML rectilinear grid"},
                                             {"ImageData", "VTK XML image"},
                                             {"PUnstructuredGrid", "VTK XML partitioned unstructured grid"},
                                             {"PStructuredGrid", "VTK XML partitioned structured grid"},
                                             {"PRectilinearGrid", "VTK XML partitioned rectilinear grid"},
                                             {"PImageData", "VTK XML partitioned image"},
                                             {"vtkOverlappingAMR", "VTK XML overlapping AMR"},
                                             {"vtkNonOverlappingAMR", "VTK XML non-overlapping AMR"},
                                             {"vtkHierarchicalBoxDataSet", "VTK XML hierarchical boxes"},
                                             {"vtkMultiBlockDataSet", "VTK XML multi-block dataset"},
                                             {"vtkPartitionedDataSet", "VTK XML partitioned dataset"},
                                             {"vtkPartitionedDataSetCollection", "VTK XML collection of parts"}}};

std::string require_supported(const std::string& found, const fs::path& file) {
    const auto* type =
        std::find_if(supported.begin(), supported.end(), [&](const XmlType& known) { return found == known.type; });
    if (type != supported.end()) return type->words;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "the dataset type UnstructuredGrid, StructuredGrid, RectilinearGrid or ImageData, a "
                             "partitioned, multi-block, AMR or Collection file",
                 .found = found.empty() ? "a VTK file that names no dataset type" : "the type " + printable(found),
                 .advice = "convert the file to one of these; fill a closed surface with tetrahedra first: cellproj "
                           "tetrahedralize"});
}

// A reader of an appended block does not look beyond it, so a lost end would go unnoticed.
void require_xml_end(const fs::path& file) {
    const std::uint64_t size = fs::file_size(file);
    const std::string tail = read_bytes(file, size - std::min<std::uint64_t>(size, head_size), head_size);
    if (tail.find("</VTKFile>") != std::string::npos) return;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string() + ", byte " + std::to_string(size),
                 .expected = "</VTKFile>",
                 .found = "the end of the file",
                 .advice = "the file is cut off: write or copy it again"});
}

// One line of a collection: a file that is one part at one time.
struct Entry {
    double time = 0.0;
    std::string part;
    fs::path file;
};

std::vector<Entry> read_entries(const fs::path& file) {
    std::vector<Entry> entries;
    vtkSmartPointer<vtkXMLDataElement> root;
    capture_errors(file, [&] {
        root = vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(file.c_str()));
    });
    vtkXMLDataElement* collection = root ? root->FindNestedElementWithName("Collection") : nullptr;
    for (int e = 0; collection && e < collection->GetNumberOfNestedElements(); ++e) {
        vtkXMLDataElement* element = collection->GetNestedElement(e);
        const char* path = element->GetAttribute("file");
        if (!path) continue;
        Entry entry;
        element->GetScalarAttribute("timestep", entry.time);
        const char* part = element->GetAttribute("part");
        const char* name = element->GetAttribute("name");
        entry.part = name && *name ? name : std::string("part ") + (part ? part : "0");
        entry.file = file.parent_path() / path;
        entries.push_back(std::move(entry));
    }
    if (entries.empty()) {
        throw Error({.kind = ErrorKind::format,
                     .place = file.string(),
                     .expected = "a Collection of DataSet elements, each with a file",
                     .found = "none",
                     .advice = "the file may be damaged: write it again"});
    }
    return entries;
}

std::vector<double> times_of(const std::vector<Entry>& entries) {
    std::vector<double> times;
    for (const Entry& entry : entries)
        times.push_back(entry.time);
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

// A file of one dataset or a tree of them, checked, as VTK has it.
vtkSmartPointer<vtkDataObject> load(const fs::path& file) {
    require_readable(file);
    require_supported(xml_dataset_type(file), file);
    require_xml_end(file);
    vtkNew<vtkXMLGenericDataObjectReader> reader;
    reader->SetFileName(file.c_str());
    update(*reader, file);
    vtkSmartPointer<vtkDataObject> data = reader->GetOutputDataObject(0);
    if (data) return data;
    throw Error({.kind = ErrorKind::format,
                 .place = file.string(),
                 .expected = "a VTK XML dataset",
                 .found = "that VTK's reader gave none",
                 .advice = "the file may be damaged: write it again"});
}

// Told about the collection: the name in it may be what is damaged.
void require_existing(const Entry& entry, const fs::path& collection) {
    std::error_code unknown;
    if (fs::exists(entry.file, unknown)) return;
    throw Error({.kind = ErrorKind::file,
                 .place = collection.string() + ", the file " + printable(entry.file.string()),
                 .expected = "a file",
                 .found = "none of that name",
                 .advice = "put it there, or name the right one in the collection"});
}

// The parts of a collection at one time as a tree, each under its name; a single one as it is.
vtkSmartPointer<vtkDataObject> load_parts(const fs::path& file, const std::vector<Entry>& entries, double time) {
    vtkNew<vtkMultiBlockDataSet> parts;
    for (const Entry& entry : entries) {
        if (entry.time != time) continue;
        require_existing(entry, file);
        const unsigned int part = parts->GetNumberOfBlocks();
        parts->SetBlock(part, load(entry.file));
        parts->GetMetaData(part)->Set(vtkCompositeDataSet::NAME(), entry.part.c_str());
    }
    if (parts->GetNumberOfBlocks() == 1) return parts->GetBlock(0);
    return parts.Get();
}

// ParaView's .pvd: a list of files, each one part at one time.
Dataset read_collection(const fs::path& file, const ReadOptions& options) {
    const std::vector<Entry> entries = read_entries(file);
    const std::vector<double> times = times_of(entries);
    const double time = times[nearest_time(times, options.time)];
    const vtkSmartPointer<vtkDataObject> data = load_parts(file, entries, time);
    Dataset dataset = blocks_to_dataset(*data, file, "VTK XML collection", options);
    dataset.times = times;
    dataset.time = time;
    return dataset;
}

}  // namespace

bool is_vtk_xml_index(const fs::path& file) {
    const std::string type = xml_dataset_type(file);
    return type == "Collection" || (type.starts_with('P') && type != "PolyData") || type.starts_with("vtk");
}

Dataset read_vtk_xml(const fs::path& file, const ReadOptions& options) {
    const std::string type = xml_dataset_type(file);
    if (type == "Collection") {
        require_xml_end(file);
        return read_collection(file, options);
    }
    const std::string format = require_supported(type, file);
    if (type.ends_with("AMR") || type == "vtkHierarchicalBoxDataSet") {
        require_xml_end(file);
        return read_vtk_amr(file, format);
    }
    return blocks_to_dataset(*load(file), file, format, options);
}

}  // namespace cellproj
