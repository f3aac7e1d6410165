// SPDX-License-Identifier: BSD-3-Clause
#include <vtkNew.h>
#include <vtkUniformGrid.h>
#include <vtkUniformGridAMR.h>
#include <vtkXMLUniformGridAMRReader.h>

#include "mesh/error.hpp"
#include "mesh/io/assemble_pieces.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

Dataset read_vtk_amr(const std::filesystem::path& file, const std::string& format) {
    vtkNew<vtkXMLUniformGridAMRReader> reader;
    reader->SetFileName(file.c_str());
    reader->SetMaximumLevelsToReadByDefault(0);  // all of them; it takes one unless told
    update(*reader, file);
    auto* amr = vtkUniformGridAMR::SafeDownCast(reader->GetOutputDataObject(0));
    std::vector<Dataset> pieces;
    std::vector<std::string> names;
    for (unsigned int level = 0; amr && level < amr->GetNumberOfLevels(); ++level)
        for (unsigned int i = 0; i < amr->GetNumberOfDataSets(level); ++i) {
            vtkUniformGrid* grid = amr->GetDataSet(level, i);
            if (!grid) continue;
            const std::string name = std::to_string(i) + " of level " + std::to_string(level);
            pieces.push_back(structured_to_dataset(*grid, file.string() + ", piece " + name, format));
            names.push_back(name);
        }
    if (pieces.empty()) {
        throw Error({.kind = ErrorKind::format,
                     .place = file.string(),
                     .expected = "pieces of an AMR dataset",
                     .found = "none",
                     .advice = "the file, or a file it names, may be damaged: write it again"});
    }
    return assemble_pieces(std::move(pieces), std::move(names), file.string());
}

}  // namespace cellproj
