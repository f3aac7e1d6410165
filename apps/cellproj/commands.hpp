// SPDX-License-Identifier: BSD-3-Clause
//
// The sub-commands. Each adds itself to the parser; its work runs when the parser meets it and throws Error on failure.
#pragma once

namespace CLI {
class App;
}

namespace cellproj::cli {

void add_check_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_tetrahedralize_command(CLI::App& app);
void add_trade_command(CLI::App& app);

}  // namespace cellproj::cli
