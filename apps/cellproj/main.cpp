// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <new>

#include "commands.hpp"

namespace {

constexpr const char* description =
    "cellproj renders volumes on unstructured meshes, without a GPU or a display.\n"
    "\n"
    "Examples:\n"
    "  cellproj info flow.vtu\n"
    "  cellproj check flow.vtu\n"
    "  cellproj render flow.vtu -o flow.png\n"
    "  cellproj render flow.vtu -o flow.png --field p --transfer tf.json --size 1024x768\n"
    "  cellproj render grid.xyz --q solution.q -o mach.png --field Mach --from -1,-2,1\n"
    "  cellproj trade flow.vtu -o trade.html\n"
    "  cellproj tetrahedralize part.stl -o part.vtu\n"
    "  cellproj render part.stl --tetrahedralize -o part.png\n"
    "  cellproj render demo:sphere -o orbit.png --orbit 360 --frames 24 --stats stats.json\n";

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{description, "cellproj"};
    app.set_version_flag("--version", "cellproj " CELLPROJ_VERSION);
    app.require_subcommand(1);
    cellproj::cli::add_render_command(app);
    cellproj::cli::add_info_command(app);
    cellproj::cli::add_check_command(app);
    cellproj::cli::add_tetrahedralize_command(app);
    cellproj::cli::add_trade_command(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::RuntimeError& outcome) {  // a command's own exit code, its words are said
        return outcome.get_exit_code();
    } catch (const CLI::ParseError& error) {
        const bool asked_for_help = error.get_exit_code() == 0;
        if (asked_for_help) return app.exit(error);
        std::fprintf(stderr, "cellproj: %s\nTry 'cellproj --help' or 'cellproj render --help'.\n", error.what());
        return 2;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "cellproj: out of memory\n");
        return 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cellproj: %s\n", error.what());
        return 1;
    }
    return 0;
}
