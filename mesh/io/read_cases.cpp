// SPDX-License-Identifier: BSD-3-Clause
//
// Results of solvers in several files or blocks: OpenFOAM, EnSight Gold, Exodus II, CGNS and Fluent.
#include <vtkCGNSReader.h>
#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkCommand.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataSet.h>
#include <vtkDummyController.h>
#include <vtkExodusIIReader.h>
#include <vtkFLUENTReader.h>
#include <vtkGenericEnSightReader.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPOpenFOAMReader.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>

#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

#include "mesh/error.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

namespace {

namespace fs = std::filesystem;

// ---- OpenFOAM ----

// The folder of a case, given by itself, by its system/controlDict or by a file .foam in it.
fs::path case_folder(const fs::path& file) {
    if (fs::is_directory(file)) return file;
    const fs::path folder = fs::absolute(file).parent_path();
    return file.filename() == "controlDict" ? folder.parent_path() : folder;
}

// A name in the case's folder from which VTK's reader finds everything; it need not exist.
fs::path name_in_case(const fs::path& folder) {
    return folder / "case.foam";
}

fs::path processor_folder(const fs::path& folder, int number) {
    return folder / ("processor" + std::to_string(number));
}

bool is_decomposed(const fs::path& folder) {
    return !fs::exists(folder / "constant" / "polyMesh") && fs::is_directory(processor_folder(folder, 0));
}

// Binary files say how wide their numbers are: arch "LSB;label=32;scalar=64".
struct NumberWidths {
    bool long_labels = false;
    bool double_scalars = true;
};

NumberWidths number_widths(const fs::path& mesh) {
    constexpr std::size_t header = 2048;
    const std::string head = read_bytes(mesh / "owner", 0, header) + read_bytes(mesh / "points", 0, header);
    return {head.find("label=64") != std::string::npos, head.find("scalar=32") == std::string::npos};
}

void require_case(const fs::path& folder, const fs::path& file) {
    for (const fs::path& needed :
         {folder / "system" / "controlDict", (is_decomposed(folder) ? folder / "processor0" : folder) / "constant"}) {
        if (fs::exists(needed)) continue;
        throw Error({.kind = ErrorKind::file,
                     .place = file.string(),
                     .expected = "an OpenFOAM case in the folder " + folder.string(),
                     .found = "no " + needed.lexically_relative(folder).string() + " in it",
                     .advice = "put the .foam file into the case's folder, or name that folder"});
    }
}

// The internal meshes of all regions, no boundary patches.
void select_volumes(vtkOpenFOAMReader& reader) {
    for (int p = 0; p < reader.GetNumberOfPatchArrays(); ++p) {
        const std::string name = reader.GetPatchArrayName(p);
        reader.SetPatchArrayStatus(name.c_str(), name.ends_with("internalMesh"));
    }
    reader.EnableAllCellArrays();
    reader.EnableAllPointArrays();
}

}  // namespace

Dataset read_openfoam(const fs::path& file, const ReadOptions& options) {
    const fs::path folder = case_folder(file);
    require_case(folder, file);
    const bool decomposed = is_decomposed(folder);
    const NumberWidths widths = number_widths((decomposed ? folder / "processor0" : folder) / "constant" / "polyMesh");
    const fs::path name = name_in_case(folder);
    vtkNew<vtkDummyController> one_process;  // a decomposed case is read by asking it, unchecked
    vtkNew<vtkPOpenFOAMReader> reader;
    reader->SetController(one_process);
    reader->SetFileName(name.c_str());
    reader->SetCaseType(decomposed ? vtkPOpenFOAMReader::DECOMPOSED_CASE : vtkPOpenFOAMReader::RECONSTRUCTED_CASE);
    reader->SetUse64BitLabels(widths.long_labels);
    reader->SetUse64BitFloats(widths.double_scalars);
    reader->CreateCellToPointOff();  // values as the solver wrote them
    reader->DecomposePolyhedraOff();
    reader->SkipZeroTimeOff();
    capture_errors(file, [&] {
        reader->UpdateInformation();
        select_volumes(*reader);
    });
    Dataset dataset =
        read_blocks(*reader, file, decomposed ? "OpenFOAM case, decomposed" : "OpenFOAM case", options);
    if (!dataset.time) return dataset;
    if (!decomposed) require_whole_openfoam_fields(folder, *dataset.time, file);
    for (int processor = 0; decomposed && fs::exists(processor_folder(folder, processor)); ++processor)
        require_whole_openfoam_fields(processor_folder(folder, processor), *dataset.time, file);
    return dataset;
}

// ---- EnSight Gold ----

namespace {

// The names of all arrays on points and cells in a tree of blocks.
std::set<std::string> array_names(vtkDataObject* data) {
    std::set<std::string> names;
    auto* tree = vtkCompositeDataSet::SafeDownCast(data);
    if (!tree) return names;
    const auto blocks = vtkSmartPointer<vtkCompositeDataIterator>::Take(tree->NewIterator());
    for (blocks->InitTraversal(); !blocks->IsDoneWithTraversal(); blocks->GoToNextItem()) {
        auto* block = vtkDataSet::SafeDownCast(blocks->GetCurrentDataObject());
        if (!block) continue;
        for (vtkDataSetAttributes* attributes :
             {static_cast<vtkDataSetAttributes*>(block->GetPointData()),
              static_cast<vtkDataSetAttributes*>(block->GetCellData())}) {
            for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
                if (const char* name = attributes->GetArrayName(i)) names.insert(name);
            }
        }
    }
    return names;
}

// VTK's reader leaves a variable out when its file is missing or cut off.
void require_all_variables(vtkGenericEnSightReader& reader, const fs::path& file) {
    const std::set<std::string> present = array_names(reader.GetOutputDataObject(0));
    const auto require = [&](const char* name) {
        if (!name || present.contains(name)) return;
        throw Error({.kind = ErrorKind::format,
                     .place = file.string() + ", variable \"" + name + "\"",
                     .expected = "its values in the file that the case names",
                     .found = "none that VTK's reader takes",
                     .advice = "that file may be missing or cut off: write or copy it again, or remove the variable "
                               "from the case"});
    };
    for (int i = 0; i < reader.GetNumberOfPointArrays(); ++i)
        require(reader.GetPointArrayName(i));
    for (int i = 0; i < reader.GetNumberOfCellArrays(); ++i)
        require(reader.GetCellArrayName(i));
}

}  // namespace

Dataset read_ensight(const fs::path& file, const ReadOptions& options) {
    const fs::path folder = fs::absolute(file).parent_path();
    vtkNew<vtkGenericEnSightReader> reader;
    reader->SetFilePath((folder.string() + "/").c_str());
    reader->SetCaseFileName(file.filename().c_str());
    reader->ReadAllVariablesOn();
    const TimeSteps steps = choose_time(*reader, file, options.time);
    update(*reader, file);
    require_all_variables(*reader, file);
    Dataset dataset = blocks_to_dataset(*reader->GetOutputDataObject(0), file, "EnSight Gold", options);
    dataset.times = steps.all;
    dataset.time = steps.read;
    return dataset;
}

// ---- Exodus II ----

Dataset read_exodus(const fs::path& file, const ReadOptions& options) {
    require_whole_netcdf(file);
    vtkNew<vtkExodusIIReader> reader;
    reader->SetFileName(file.c_str());
    capture_errors(file, [&] {
        if (reader->CanReadFile(file.c_str()) == 0) {
            throw std::runtime_error("no Exodus II file that can be opened");
        }
        reader->UpdateInformation();
        for (const int kind : {vtkExodusIIReader::NODAL, vtkExodusIIReader::ELEM_BLOCK}) {
            reader->SetAllArrayStatus(kind, 1);
        }
    });
    reader->ApplyDisplacementsOff();
    reader->GenerateObjectIdCellArrayOff();
    return read_blocks(*reader, file, "Exodus II", options);
}

// ---- CGNS ----

Dataset read_cgns(const fs::path& file, const ReadOptions& options) {
    vtkNew<vtkCGNSReader> reader;
    reader->SetFileName(file.c_str());
    capture_errors(file, [&] {
        reader->UpdateInformation();
        reader->EnableAllBases();
        reader->EnableAllFamilies();
        reader->EnableAllPointArrays();
        reader->EnableAllCellArrays();
    });
    return read_blocks(*reader, file, "CGNS", options);
}

// ---- Fluent ----

namespace {

// A mesh without a solution is a good file, but an error to VTK's reader; its other errors go where they always do.
void pass_on_error(vtkObject*, unsigned long, void*, void* text) {
    const auto* message = static_cast<const char*>(text);
    if (std::string_view(message).find("Could not open data file") != std::string_view::npos) return;
    vtkOutputWindow::GetInstance()->DisplayErrorText(message);
}

}  // namespace

Dataset read_fluent(const fs::path& file, const ReadOptions& options) {
    vtkNew<vtkFLUENTReader> reader;
    reader->SetFileName(file.c_str());
    vtkNew<vtkCallbackCommand> errors;
    errors->SetCallback(pass_on_error);
    if (!fs::exists(fs::path(file).replace_extension(".dat"))) reader->AddObserver(vtkCommand::ErrorEvent, errors);
    capture_errors(file, [&] {
        reader->UpdateInformation();
        for (int a = 0; a < reader->GetNumberOfCellArrays(); ++a)
            reader->SetCellArrayStatus(reader->GetCellArrayName(a), 1);
    });
    return read_blocks(*reader, file, "Fluent", options);
}

}  // namespace cellproj
