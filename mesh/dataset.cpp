// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/dataset.hpp"

#include <cassert>

namespace cellproj {

const char* to_string(CellKind kind) {
    switch (kind) {
        case CellKind::tetrahedron:
            return "tetrahedron";
        case CellKind::hexahedron:
            return "hexahedron";
    }
    assert(!"to_string: not a CellKind");
    return "";
}

}  // namespace cellproj
