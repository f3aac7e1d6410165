// SPDX-License-Identifier: BSD-3-Clause
//
// By itself and compiled as C++17: GCC 12 does not accept VTK 9.1's vtkSMPTools.h as C++20.
#include <vtkSMPTools.h>

namespace cellproj {

void use_one_thread();  // vtk_conversion.hpp, which is C++20

void use_one_thread() {
    vtkSMPTools::SetBackend("Sequential");
}

}  // namespace cellproj
