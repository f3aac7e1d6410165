// SPDX-License-Identifier: BSD-3-Clause
//
// A scene's mesh and field as VTK wants them.
#pragma once

#include "render/scene.hpp"

class vtkUnstructuredGrid;
template <class T>
class vtkSmartPointer;

namespace cellproj::bench {

vtkSmartPointer<vtkUnstructuredGrid> make_vtk_grid(const Scene& scene);  // points and scalars in float

}  // namespace cellproj::bench
