// SPDX-License-Identifier: BSD-3-Clause
//
// VTK's mappers of unstructured grids, as a user with their documentation would set them, for the sake of the picture:
// - points and scalars in float, colour and opacity with a node at every breakpoint of ours (the integrators of rays skip opacity nodes
//   where no colour node stands), opacity linear in the extinction (τ = opacity / unit distance is what they compute);
// - a picture of the asked size, every pixel, no adaptive sampling distance, all CPUs, no depth buffer of other things;
// - a frame is vtkRenderWindow::Render and the end of all GL commands; reading the pixels is not counted.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/bench/frames_contender.hpp"

namespace cellproj::bench {

// "vtk-projected" (vtkProjectedTetrahedraMapper), "vtk-preintegration" and "vtk-linear" (vtkUnstructuredGridVolumeRayCastMapper, Bunyk,
// with either integrator), "vtk-zsweep" (vtkUnstructuredGridVolumeZSweepMapper).
std::vector<std::string> vtk_contender_names();
std::unique_ptr<Contender> make_vtk_contender(const std::string& name, const Scene& scene, ImageSize size);

}  // namespace cellproj::bench
