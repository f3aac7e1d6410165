// SPDX-License-Identifier: BSD-3-Clause
//
// Volumes of voxels: MetaImage, NRRD and SLC. Each voxel becomes a point at its centre.
#include <vtkImageData.h>
#include <vtkMetaImageReader.h>
#include <vtkNew.h>
#include <vtkNrrdReader.h>
#include <vtkSLCReader.h>

#include "mesh/error.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "mesh/io/vtk_readers.hpp"

namespace cellproj {

Dataset read_meta_image(const std::filesystem::path& file) {
    vtkNew<vtkMetaImageReader> reader;
    reader->SetFileName(file.c_str());
    update(*reader, file);
    return structured_to_dataset(*reader->GetOutput(), file, "MetaImage");
}

Dataset read_nrrd(const std::filesystem::path& file) {
    vtkNew<vtkNrrdReader> reader;
    reader->SetFileName(file.c_str());
    update(*reader, file);
    return structured_to_dataset(*reader->GetOutput(), file, "NRRD");
}

Dataset read_slc(const std::filesystem::path& file) {
    vtkNew<vtkSLCReader> reader;
    reader->SetFileName(file.c_str());
    update(*reader, file);
    return structured_to_dataset(*reader->GetOutput(), file, "SLC");
}

}  // namespace cellproj
