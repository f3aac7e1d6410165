// SPDX-License-Identifier: BSD-3-Clause
//
// Colours by name: viridis, magma, inferno, plasma (van der Walt and Smith), cividis (Nuñez, Anderton, Renslow), turbo
// (Mikhailov), cool-warm (Moreland) and gray. Licences stand beside the tables in presets.cpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "classify/transfer_function.hpp"

namespace cellproj {

// In the order above; the first is the default.
const std::vector<std::string>& preset_names();

// The colours of preset `name` from its first at `low` to its last at `high`, low ≤ high; sRGB in 0..1, within 0.5/255 of the
// published table. Spread over ln s on a logarithmic axis, with as many nodes between as `on_axis` asks for. low = high gives
// the last colour alone. Throws Error at `place`: (option) for an unknown name, (data) where `on_axis` does.
std::vector<ColorNode> preset_colors(std::string_view name, double low, double high, ScalarAxis axis = ScalarAxis::linear,
                                     const std::string& place = "colors");

}  // namespace cellproj
