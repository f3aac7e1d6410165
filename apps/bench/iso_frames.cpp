// SPDX-License-Identifier: BSD-3-Clause
//
// cellproj_isosurfaces: what isosurfaces cost as their number grows, and VTK's contour filter beside them: the tables in render/README.md.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/bench/cpu_time.hpp"
#include "apps/bench/frames_process.hpp"
#include "apps/bench/frames_scenes.hpp"
#include "apps/bench/iso_contender.hpp"
#include "apps/scenes/measured_scenes.hpp"
#include "mesh/scalar_field.hpp"
#include "render/prepared_scene.hpp"
#include "render/statistics.hpp"

namespace {

using namespace cellproj;
using namespace cellproj::bench;

constexpr const char* description =
    "Draws isosurfaces of one field by cellproj's backends and, where it was built with it, by VTK's contour filter, in turn,\n"
    "a new view each frame, each in a process of its own, and prints three tables: ten values against two in the same cells;\n"
    "1 to 1000 values; one value flat and smooth (RKE00, Table 1).\n"
    "\n"
    "change: from other isovalues to all that needs no view; frame: camera to pixels; both wall clock [ms], user: CPU time of\n"
    "all threads for the frame [ms]. Medians. Ratios are of user times.";

// ---- A contender's process.

struct Scenery {
    FieldMesh given;
    Scene scene;
};

Scenery make_scenery(const std::string& name) {
    Scenery made{make_mesh(name), {}};
    made.scene.mesh = std::make_shared<TetMesh>(made.given.mesh);
    made.scene.field = std::make_shared<ScalarField>(made.given.field);
    return made;
}

std::vector<double> values_of(const IsoTask& task, const ScalarField& field) {
    const auto at = [&](double share) { return quantile(field.values, share); };
    std::vector<double> values;
    for (int i = 0; i < task.count; ++i) {
        double value = 0;
        if (task.places == IsoPlaces::quantiles) value = at((i + 1.0) / (task.count + 1.0));
        if (task.places == IsoPlaces::one) value = at(task.quantile);
        if (task.places == IsoPlaces::same_cells) value = at(0.5) + 1e-4 * (at(0.99) - at(0.01)) * i / std::max(task.count - 1, 1);
        if (values.empty() || value > values.back()) values.push_back(value);
    }
    return values;
}

Scene scene_of(const IsoTask& task, const Scenery& scenery) {
    Scene scene = scenery.scene;
    std::vector<IsoSurface> list;
    for (const double value : values_of(task, *scene.field)) list.push_back({value, {1, 0.5, 0.1}, task.opacity, {}});
    scene.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(list)), task.shading, {}});
    const TransferFunction nothing(OpticalModel::density, {{0, glm::dvec3(1)}}, {{0, 0}});
    scene.transfer = std::make_shared<TransferFunction>(task.medium ? make_transfer("ramp", scenery.given) : nothing);
    return scene;
}

struct Change {
    double ms;
    std::size_t values, crossed, triangles;
};
struct Frame {
    double ms, user_ms;
};
struct Order {
    bool change;  // to `task`; else a frame of `view`
    IsoTask task;
    int view;
};

void serve(const std::string& contender_name, const std::string& scene_name, ImageSize size, const Pipe& pipe) {
    const Scenery scenery = make_scenery(scene_name);
    const Bounds box = bounds(scenery.scene.mesh->points);
    const auto contender = make_iso_contender(contender_name, size);
    for (Order order{}; pipe.receive(order);) {
        if (order.change) {
            const Scene scene = scene_of(order.task, scenery);
            const Stopwatch changing;
            contender->set(scene);
            const double ms = changing.ms();
            const PreparedSurfaces surfaces(scene, SceneUnits{box.diagonal() / 2, range(scene.field->values).low, range(scene.field->values).high});
            pipe.send(Change{ms, surfaces.values().size(), surfaces.crossed().size(), contender->triangles()});
        } else {
            const double user = user_ms();
            const Stopwatch drawing;
            contender->draw(scenes::measured_view(order.view, box));
            pipe.send(Frame{drawing.ms(), user_ms() - user});
        }
    }
}

// ---- The parent: who draws what when.

struct Options {
    std::string scene = "bluntfin";
    std::vector<std::string> contenders;  // all but gl's tables, unless told otherwise
    std::vector<int> values{1, 2, 10, 100, 1000};
    int size = 512, frames = 3, rounds = 3, most_translucent_vtk = 10, most_opaque_vtk = 10;
};

struct Cost {
    Change change{};
    double change_ms = 0, frame_ms = 0, user_ms = 0;
    std::string failure;
};

using Players = std::map<std::string, std::unique_ptr<Child>>;

// A frame longer than this is timed once only. [ms]
constexpr double long_frame = 1500;

// The costs of all tasks by contender, in their order. Rounds over all of them: what disturbs the machine disturbs all alike.
std::map<std::string, std::vector<Cost>> measure(const Options& options, Players& players, const std::vector<IsoTask>& tasks) {
    std::map<std::string, std::vector<Cost>> costs;
    struct Times {
        std::vector<double> change, frame, user;
    };
    std::map<std::string, std::vector<Times>> times;
    for (const std::string& name : options.contenders) {
        costs[name].resize(tasks.size());
        times[name].resize(tasks.size());
    }
    int view = 0;
    const auto play = [&](const std::string& name, std::size_t i) {
        Child& player = *players.at(name);
        Times& t = times[name][i];
        player.send(Order{true, tasks[i], 0});
        costs[name][i].change = player.receive<Change>();
        t.change.push_back(costs[name][i].change.ms);
        player.send(Order{false, {}, view});  // shaders are compiled, buffers filled
        const auto first = player.receive<Frame>();
        for (int frame = 0; frame < (first.ms > long_frame ? 1 : options.frames); ++frame) {
            player.send(Order{false, {}, view + 1 + frame});
            const auto cost = player.receive<Frame>();
            t.frame.push_back(cost.ms);
            t.user.push_back(cost.user_ms);
        }
    };
    for (int round = 0; round < options.rounds; ++round, view += options.frames + 1)
        for (std::size_t i = 0; i < tasks.size(); ++i)
            for (const std::string& name : options.contenders) {
                Cost& cost = costs[name][i];
                const bool vtk = name == "vtk";
                const int most = tasks[i].opacity < 1 ? options.most_translucent_vtk : options.most_opaque_vtk;
                if (vtk && (tasks[i].medium || tasks[i].count > most)) cost.failure = "-";
                const auto& frames = times[name][i].frame;
                if (!cost.failure.empty() || (round > 0 && frames.front() > long_frame)) continue;
                std::fprintf(stderr, "round %d: %d values, %s      \r", round + 1, tasks[i].count, name.c_str());
                try {
                    play(name, i);
                } catch (const std::exception& error) {
                    cost.failure = error.what();
                }
            }
    for (const std::string& name : options.contenders)
        for (std::size_t i = 0; i < tasks.size(); ++i) {
            if (!costs[name][i].failure.empty()) continue;
            costs[name][i].change_ms = median(times[name][i].change);
            costs[name][i].frame_ms = median(times[name][i].frame);
            costs[name][i].user_ms = median(times[name][i].user);
        }
    std::fprintf(stderr, "%40s\r", "");
    return costs;
}

std::string in_words(const IsoTask& task) {
    std::string text = task.medium ? "in a medium" : task.opacity < 1 ? "translucent" : "opaque";
    return text + (task.shading == Shading::flat ? ", flat" : ", smooth");
}

void print_counts(const Options& options, Players& players) {
    std::vector<IsoTask> tasks;
    for (const double opacity : {1.0, 0.1})
        for (const int count : options.values) tasks.push_back({.count = count, .opacity = opacity});
    const auto costs = measure(options, players, tasks);
    std::printf("\n%d² pixels, perspective, smooth; values at the quantiles of the field; opacity 1 and .1\n\n| | values | cells crossed |", options.size);
    for (const std::string& name : options.contenders) std::printf(" %s: change | frame | user |", name.c_str());
    std::printf("%s\n|---|---|---|", costs.contains("vtk") ? " triangles |" : "");
    for (std::size_t i = 0; i < 3 * options.contenders.size() + (costs.contains("vtk") ? 1 : 0); ++i) std::printf("---|");
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        const Change& known = costs.at(options.contenders.front())[i].change;
        std::printf("\n| %s | %zu | %zu |", tasks[i].opacity < 1 ? "translucent" : "opaque", known.values, known.crossed);
        for (const std::string& name : options.contenders) {
            const Cost& cost = costs.at(name)[i];
            if (cost.failure.empty()) std::printf(" %.0f | %.1f | %.1f |", cost.change_ms, cost.frame_ms, cost.user_ms);
            else std::printf(" %s | | |", cost.failure.c_str());
        }
        if (costs.contains("vtk")) std::printf(" %zu |", costs.at("vtk")[i].change.triangles);
    }
    std::printf("\n");
}

// Rows of two tasks each, whose ratio counts.
void print_pairs(const Options& options, Players& players, const char* heading, const char* columns, const std::vector<IsoTask>& tasks,
                 const std::function<std::string(const IsoTask&)>& label) {
    Options ours = options;
    std::erase(ours.contenders, "vtk");
    if (ours.contenders.empty()) return;
    const auto costs = measure(ours, players, tasks);
    std::printf("\n%s\n\n| | cells crossed |", heading);
    for (const std::string& name : ours.contenders) std::printf(" %s: %s |", name.c_str(), columns);
    std::printf("\n|---|---|");
    for (std::size_t i = 0; i < 3 * ours.contenders.size(); ++i) std::printf("---|");
    for (std::size_t i = 0; i + 1 < tasks.size(); i += 2) {
        std::printf("\n| %s | %zu |", label(tasks[i]).c_str(), costs.begin()->second[i].change.crossed);
        for (const std::string& name : ours.contenders) {
            const Cost &a = costs.at(name)[i], &b = costs.at(name)[i + 1];
            if (a.failure.empty() && b.failure.empty()) std::printf(" %.1f | %.1f | %.2f |", a.user_ms, b.user_ms, b.user_ms / a.user_ms);
            else std::printf(" %s | | |", (a.failure + b.failure).c_str());
        }
    }
    std::printf("\n");
}

void print_same_cells(const Options& options, Players& players) {
    std::vector<IsoTask> tasks;
    for (const bool medium : {false, true})
        for (const double opacity : {1.0, 0.1})
            for (const Shading shading : {Shading::flat, Shading::smooth}) {
                if (medium && (opacity == 1.0 || shading == Shading::flat)) continue;
                for (const int count : {2, 10})
                    tasks.push_back({.places = IsoPlaces::same_cells, .count = count, .opacity = opacity, .shading = shading, .medium = medium});
            }
    print_pairs(options, players, "2 and 10 values in the same cells, user ms", "2 values | 10 | ratio", tasks, in_words);
}

void print_flat_and_smooth(const Options& options, Players& players) {
    std::vector<IsoTask> tasks;
    for (const double quantile : {0.1, 0.3, 0.5, 0.7, 0.9})
        for (const Shading shading : {Shading::flat, Shading::smooth})
            tasks.push_back({.places = IsoPlaces::one, .count = 1, .quantile = quantile, .shading = shading});
    print_pairs(options, players, "One opaque surface, user ms (RKE00, Table 1: smooth over flat 2.0 to 2.4)", "flat | smooth | ratio", tasks,
                [](const IsoTask& task) { return "quantile " + std::to_string(task.quantile).substr(0, 3); });
}

void run(const Options& options) {
    const VirtualDisplay display(std::ranges::count(options.contenders, "vtk") > 0);
    Players players;
    for (const std::string& name : options.contenders) {
        players[name] = std::make_unique<Child>([&](const Pipe& pipe) {
            if (name == "vtk" && !display.failure().empty()) throw std::runtime_error(display.failure());
            serve(name, options.scene, {options.size, options.size}, pipe);
        });
    }
    std::printf("%s\n", options.scene.c_str());
    print_same_cells(options, players);
    print_counts(options, players);
    print_flat_and_smooth(options, players);
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);  // a contender that dies is told in its row
    Options options;
    for (const std::string& name : iso_contender_names())
        if (!name.starts_with("gl-")) options.contenders.push_back(name);
    CLI::App app{description, "cellproj_isosurfaces"};
    app.add_option("--scene", options.scene, "bluntfin, grid:N (N points along an edge), delaunay:N (N points)")->capture_default_str();
    app.add_option("--contenders", options.contenders)->delimiter(',')->check(CLI::IsMember(iso_contender_names()));
    app.add_option("--values", options.values, "numbers of isovalues")->delimiter(',')->check(CLI::Range(1, 100000));
    app.add_option("--size", options.size, "pixels along an edge of the picture")->check(CLI::Range(1, 16384))->capture_default_str();
    app.add_option("--frames", options.frames, "timed in each round")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--rounds", options.rounds)->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--vtk-translucent", options.most_translucent_vtk, "most translucent isovalues that VTK is asked for")->capture_default_str();
    app.add_option("--vtk-opaque", options.most_opaque_vtk, "most opaque ones")->capture_default_str();
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    try {
        run(options);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cellproj_isosurfaces: %s\n", error.what());
        return 1;
    }
}
