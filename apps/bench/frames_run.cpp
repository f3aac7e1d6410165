// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/frames_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "apps/bench/cpu_time.hpp"
#include "apps/bench/frames_contender.hpp"
#include "apps/bench/frames_process.hpp"
#include "apps/bench/frames_scenes.hpp"
#include "apps/scenes/measured_scenes.hpp"
#include "render/judge/reference.hpp"
#include "render/statistics.hpp"
#if CELLPROJ_BENCH_VTK
#include "apps/bench/vtk_frames.hpp"
#endif

namespace cellproj::bench {

namespace {

using Projection = Camera::Projection;

class OurRenderer final : public Contender {
public:
    OurRenderer(Backend backend, Scene scene, const ContenderOptions& options)
        : backend_(backend), scene_(std::move(scene)), options_(options) {}

    void set_up() override {
        renderer_ = make_renderer(backend_, {.threads = backend_ == Backend::cpu ? options_.threads : 0});
        renderer_->prepare(scene_, options_.quality);
    }
    void draw(const Camera& camera) override { image_ = renderer_->render(scene_, camera, options_.size, options_.quality); }
    Statistics explain(const Camera& camera) override {
        Statistics statistics;
        renderer_->render(scene_, camera, options_.size, options_.quality, &statistics);
        return statistics;
    }
    Image picture() const override { return image_; }

private:
    Backend backend_;
    Scene scene_;
    ContenderOptions options_;
    std::unique_ptr<Renderer> renderer_;
    Image image_;
};

// A scene as it goes from the child that made it to those that draw it.
struct SceneHead {
    std::size_t cells;
    Bounds box;
};

void write_scene(SharedBytes& bytes, const FieldMesh& scene) {
    bytes.write(scene.mesh.points);
    bytes.write(scene.mesh.tets);
    bytes.write(scene.field.values);
    bytes.write(std::vector<double>{scene.low, scene.high});
}

Scene read_scene(SharedBytes& bytes, const std::string& transfer) {
    FieldMesh scene;
    scene.mesh.points = bytes.read<glm::dvec3>();
    scene.mesh.tets = bytes.read<std::array<VertexId, 4>>();
    scene.field = {"f", FieldLocation::points, bytes.read<double>()};
    const auto range = bytes.read<double>();
    scene.low = range[0];
    scene.high = range[1];
    auto function = std::make_shared<TransferFunction>(make_transfer(transfer, scene));
    return {std::make_shared<TetMesh>(std::move(scene.mesh)), std::make_shared<ScalarField>(std::move(scene.field)), function};
}

// What a contender answers: once for set-up and first frame, then for each frame.
struct FirstCost {
    double set_up_ms, first_ms, peak_bytes;
    glm::dvec2 ray_shift;
};
struct FrameCost {
    double frame_ms, user_ms, sort_ms, project_ms, draw_ms, fragments;
};

std::string projection_name(Projection projection) { return projection == Projection::parallel ? "parallel" : "perspective"; }

// What a contender's process is to draw.
struct Task {
    Row row;
    Projection projection;
    Bounds box;
    ContenderOptions options;
};

// Shown over black, as VTK's are.
void save_picture(const std::filesystem::path& folder, const Row& row, const Image& image) {
    std::string name = row.scene + "_" + row.transfer + "_" + row.projection + "_" + std::to_string(row.size) + "_" + row.contender + ".png";
    std::replace(name.begin(), name.end(), ':', '-');
    write_png(image, folder / name, {.background = glm::dvec3(0), .bits = 8, .text = {}});
}

// The body of a contender's process: answers a number of a view with the cost of its frame.
void serve(const Task& task, SharedBytes& scene_bytes, SharedBytes& picture_bytes, const std::filesystem::path& pictures,
           const Pipe& pipe) {
    use_cpus(task.options.threads);
    const auto contender = make_contender(task.row.contender, read_scene(scene_bytes, task.row.transfer), task.options);
    forget_peak_memory();
    const std::size_t before = peak_memory_bytes();
    const Stopwatch watch;
    contender->set_up();
    const double set_up_ms = watch.ms();
    contender->draw(scenes::measured_view(0, task.box, task.projection));
    const double first_ms = watch.ms();
    const std::size_t peak = peak_memory_bytes();
    const Image image = contender->picture();
    picture_bytes.write(image.pixels);
    if (!pictures.empty()) save_picture(pictures, task.row, image);
    pipe.send(FirstCost{set_up_ms, first_ms, static_cast<double>(peak > before ? peak - before : 0), contender->ray_shift()});
    for (int view = 0; pipe.receive(view);) {
        const Camera camera = scenes::measured_view(view, task.box, task.projection);
        const double user = user_ms();
        const Stopwatch frame;
        contender->draw(camera);
        const double frame_ms = frame.ms(), frame_user_ms = user_ms() - user;
        // Of another view: the order of the same one would follow from the last.
        const Statistics statistics = contender->explain(scenes::measured_view(view + 1000, task.box, task.projection));
        const auto& ms = statistics.ms;
        const bool told = !statistics.backend.empty();
        const auto fragments = static_cast<double>(statistics.counts.fragments);
        pipe.send(FrameCost{frame_ms, frame_user_ms, told ? ms.sort : unknown, told ? ms.project : unknown,
                            told ? ms.draw : unknown, fragments > 0 ? fragments : unknown});
    }
}

double median_of(const std::vector<FrameCost>& costs, double FrameCost::*part) {
    std::vector<double> values;
    for (const FrameCost& cost : costs) values.push_back(cost.*part);
    return std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); }) ? unknown : median(std::move(values));
}

// A contender's process, its costs so far and its first picture.
struct Player {
    Task task;
    std::unique_ptr<SharedBytes> picture = std::make_unique<SharedBytes>();
    std::unique_ptr<Child> process;
    glm::dvec2 ray_shift{0, 0};
    std::vector<FrameCost> costs;

    // Runs `action`; what it throws becomes the row's failure and the end of the process.
    template <typename Action>
    void attempt(const Action& action) {
        if (!task.row.failure.empty()) return;
        try {
            action();
        } catch (const std::exception& error) {
            task.row.failure = error.what();
            process.reset();
        }
    }

    void first(SharedBytes& scene, const std::filesystem::path& pictures) {
        attempt([&] {
            process = std::make_unique<Child>([&](const Pipe& pipe) { serve(task, scene, *picture, pictures, pipe); });
            const auto cost = process->receive<FirstCost>();
            task.row.set_up_ms = cost.set_up_ms;
            task.row.first_ms = cost.first_ms;
            task.row.peak_bytes = cost.peak_bytes;
            ray_shift = cost.ray_shift;
        });
    }
    void frame(int view) {
        attempt([&] {
            process->send(view);
            costs.push_back(process->receive<FrameCost>());
        });
    }
    void finish() {
        process.reset();
        if (costs.empty()) return;
        Row& row = task.row;
        row.frame_ms = median_of(costs, &FrameCost::frame_ms);
        row.user_ms = median_of(costs, &FrameCost::user_ms);
        row.sort_ms = median_of(costs, &FrameCost::sort_ms);
        row.project_ms = median_of(costs, &FrameCost::project_ms);
        row.draw_ms = median_of(costs, &FrameCost::draw_ms);
        row.fragments = median_of(costs, &FrameCost::fragments);
    }
};

// The truth at the places where a contender's rays pass.
std::vector<PixelTruth> truth(const Reference& judge, const Camera& camera, ImageSize size, const std::vector<PixelId>& pixels,
                              glm::dvec2 shift) {
    if (shift == glm::dvec2(0)) return judge.pixels(camera, size, pixels);
    std::vector<PixelTruth> truths;
    for (const PixelId& pixel : pixels) {
        const Light light = judge.light(judge.index().ray(camera, size, glm::dvec2(pixel.x + 0.5, pixel.y + 0.5) + shift));
        truths.push_back({pixel, light, light, light});
    }
    return truths;
}

// In a process of its own: the errors of all players of one scene and transfer function.
void judge(std::vector<Player>& players, SharedBytes& scene_bytes, int judged) {
    std::fprintf(stderr, "  judging %d pixels\n", judged);
    Child process([&](const Pipe& pipe) {
        const Reference reference(read_scene(scene_bytes, players.front().task.row.transfer));
        for (Player& player : players) {
            ErrorMeasure error{unknown, unknown, unknown};
            if (player.task.row.failure.empty()) {
                const ImageSize size = player.task.options.size;
                const Camera camera = scenes::measured_view(0, player.task.box, player.task.projection);
                Image image(size.width, size.height);
                image.pixels = player.picture->read<glm::vec4>();
                const auto sample = reference.sample(camera, size, static_cast<std::size_t>(judged));
                error = compare(image, truth(reference, camera, size, sample, player.ray_shift)).color;
            }
            pipe.send(error);
        }
    });
    for (Player& player : players) {
        const auto error = process.receive<ErrorMeasure>();
        player.task.row.rms = error.rms;
        player.task.row.maximum = error.maximum;
    }
}

// All contenders with as many threads as asked for, in one situation.
std::vector<Player> play(const RunOptions& options, const Task& situation, SharedBytes& scene, const std::string& no_display) {
    std::vector<Player> players;
    for (const int threads : options.threads)
        for (const std::string& name : options.contenders) {
            Player& player = players.emplace_back();
            player.task = situation;
            player.task.row.contender = name;
            player.task.row.threads = threads;
            player.task.options.threads = threads;
            if (needs_display(name)) player.task.row.failure = no_display;
        }
    const Row& row = situation.row;
    for (Player& player : players) {
        std::fprintf(stderr, "%s %s %s %d %s: ", row.scene.c_str(), row.transfer.c_str(), row.projection.c_str(), row.size,
                     player.task.row.contender.c_str());
        player.first(scene, options.pictures);
        if (player.task.row.failure.empty()) std::fprintf(stderr, "first picture after %.0f ms\n", player.task.row.first_ms);
        else std::fprintf(stderr, "%s\n", player.task.row.failure.c_str());
    }
    for (int view = 1; view <= options.frames; ++view)
        for (Player& player : players) player.frame(view);
    for (Player& player : players) player.finish();
    return players;
}

}  // namespace

std::vector<std::string> contender_names() {
    std::vector<std::string> names{"cpu", "cpu-pixel", "gl"};
#if CELLPROJ_BENCH_VTK
    const auto vtk = vtk_contender_names();
    names.insert(names.end(), vtk.begin(), vtk.end());
#endif
    return names;
}

bool needs_display(const std::string& name) { return name.starts_with("vtk-"); }

std::unique_ptr<Contender> make_contender(const std::string& name, Scene scene, const ContenderOptions& options) {
    ContenderOptions chosen = options;
    chosen.quality.order_per_pixel = name == "cpu-pixel";
    if (name == "cpu" || name == "cpu-pixel") return std::make_unique<OurRenderer>(Backend::cpu, std::move(scene), chosen);
    if (name == "gl") return std::make_unique<OurRenderer>(Backend::gl_osmesa, std::move(scene), chosen);
#if CELLPROJ_BENCH_VTK
    if (needs_display(name)) return make_vtk_contender(name, scene, options.size);
#endif
    throw std::invalid_argument("no contender is called " + name);
}

std::vector<Row> run(const RunOptions& options) {
    const bool display_wanted = std::any_of(options.contenders.begin(), options.contenders.end(), needs_display);
    const VirtualDisplay display(display_wanted);
    std::vector<Row> rows;
    for (const std::string& name : options.scenes) {
        SharedBytes bytes;
        Child maker([&](const Pipe& pipe) {
            const FieldMesh scene = make_mesh(name);
            write_scene(bytes, scene);
            pipe.send(SceneHead{scene.mesh.tets.size(), bounds(scene.mesh.points)});
        });
        const auto head = maker.receive<SceneHead>();
        std::fprintf(stderr, "%s: %zu tetrahedra\n", name.c_str(), head.cells);
        for (const std::string& transfer : options.transfers) {
            std::vector<Player> played;
            for (const Projection projection : options.projections)
                for (const int size : options.sizes) {
                    Task situation;
                    situation.row.scene = name;
                    situation.row.cells = head.cells;
                    situation.row.transfer = transfer;
                    situation.row.projection = projection_name(projection);
                    situation.row.size = size;
                    situation.projection = projection;
                    situation.box = head.box;
                    situation.options = {{size, size}, {.method = options.method}, 0};
                    for (Player& player : play(options, situation, bytes, display.failure())) played.push_back(std::move(player));
                }
            if (options.judged > 0) judge(played, bytes, options.judged);
            for (const Player& player : played) rows.push_back(player.task.row);
        }
    }
    return rows;
}

}  // namespace cellproj::bench
