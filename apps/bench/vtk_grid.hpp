// SPDX-License-Identifier: BSD-3-Clause
//
// A scene's mesh and field, and a camera, as VTK wants them.
#pragma once

#include "project/camera.hpp"
#include "render/scene.hpp"

class vtkCamera;
class vtkUnstructuredGrid;
template <class T>
class vtkSmartPointer;

namespace cellproj::bench {

vtkSmartPointer<vtkUnstructuredGrid> make_vtk_grid(const Scene& scene);  // points and scalars in float
void set_vtk_view(vtkCamera& view, const Camera& camera);

}  // namespace cellproj::bench
