// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesher.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "mesh/child_process.hpp"
#include "mesh/error.hpp"
#include "mesh/mesher_format.hpp"

namespace cellproj {

namespace {

constexpr const char* mesher_name = "cellproj-mesher";

std::string in_words(double number) {
    std::ostringstream text;
    text << number;
    return text.str();
}

[[noreturn]] void refuse_option(const char* name, const char* expected, double found) {
    throw Error({.kind = ErrorKind::option,
                 .place = std::string("mesher option ") + name,
                 .expected = expected,
                 .found = in_words(found),
                 .advice = "see mesh/mesher.hpp"});
}

void validate(const MesherOptions& options) {
    const auto require_bound = [](const char* name, double bound) {
        if (!std::isfinite(bound) || bound < 0.0) refuse_option(name, "a finite number ≥ 0", bound);
    };
    require_bound("max_volume", options.max_volume);
    require_bound("radius_edge_ratio", options.radius_edge_ratio);
    if (!(options.wrap >= 0.0 && options.wrap <= 1.0)) refuse_option("wrap", "a number from 0 to 1", options.wrap);
    if (!(options.timeout_seconds > 0.0)) refuse_option("timeout_seconds", "a number > 0", options.timeout_seconds);
}

// The last line that is not empty, since programs say last why they stop; without the name of the program before it.
std::string last_line(std::string_view text) {
    const std::size_t end = text.find_last_not_of(" \t\r\n");
    if (end == std::string_view::npos) return {};
    text = text.substr(0, end + 1);
    text.remove_prefix(text.find_last_of('\n') + 1);
    if (const std::string name = std::string(mesher_name) + ": "; text.starts_with(name))
        text.remove_prefix(name.size());
    return std::string(text);
}

std::string signal_name(int signal) {
    const char* abbreviation = sigabbrev_np(signal);
    return abbreviation ? std::string("SIG") + abbreviation : "signal " + std::to_string(signal);
}

[[noreturn]] void fail(const std::string& place, const std::string& found, const std::string& advice) {
    throw Error({.kind = ErrorKind::mesher,
                 .place = place,
                 .expected = "a tetrahedral mesh",
                 .found = found,
                 .advice = advice});
}

void require_success(const ChildResult& result, const std::string& place, double timeout_seconds) {
    const std::string said = last_line(result.messages);
    const std::string quote = said.empty() ? "" : " (it said: " + said + ")";
    switch (result.end) {
        case ChildResult::End::timed_out:
            fail(place, "no answer after " + in_words(timeout_seconds) + " s" + quote,
                 "it was killed; ask for coarser cells or allow more time");
        case ChildResult::End::signalled:
            fail(place, std::string(mesher_name) + " died of " + signal_name(result.code) + quote,
                 "TetGen crashes on some inputs: points that all lie in one plane, surfaces that intersect themselves "
                 "or "
                 "are not closed; repair the surface");
        case ChildResult::End::exited:
            if (result.code == 0) return;
            fail(place, (said.empty() ? "no message" : said) + " (exit status " + std::to_string(result.code) + ")",
                 "check that the surface is closed and does not intersect itself");
        case ChildResult::End::stopped:
            return;  // it talked nonsense: the decoder says what is wrong with it
    }
}

// An answer that cannot be used is the mesher's failure, not the caller's data.
void validate_answer(const TetMesh& mesh, const std::string& place) {
    if (mesh.tets.empty()) {
        fail(place, "no cells", "the surface encloses no volume: close it, and place hole seeds inside voids only");
    }
    try {
        validate(mesh, place);
    } catch (const Error& error) {
        throw Error({.kind = ErrorKind::mesher,
                     .place = error.place(),
                     .expected = error.expected(),
                     .found = error.found(),
                     .advice = error.advice()});
    }
}

bool is_program(const std::filesystem::path& file) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
}

// Where to look, in this order, when the environment does not name it.
std::vector<std::filesystem::path> mesher_candidates() {
    std::vector<std::filesystem::path> candidates;
    std::error_code no_proc;
    if (const auto self = std::filesystem::read_symlink("/proc/self/exe", no_proc); !no_proc) {
        const std::filesystem::path folder = self.parent_path();
        candidates.push_back(folder / mesher_name);
        candidates.push_back(folder.parent_path() / "libexec" / "cellproj" / mesher_name);
    }
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        if (!folder.empty()) candidates.push_back(std::filesystem::path(folder) / mesher_name);
    }
    return candidates;
}

struct Reply {
    std::string place;  // for messages about it
    std::string bytes;
};

Reply ask(const std::string& request, const MesherOptions& options) {
    const std::filesystem::path program = options.program.empty() ? find_mesher() : options.program;
    // More output than was announced, or none that could become an answer: no use in waiting for the rest.
    const auto is_garbage = [](std::string_view output) {
        const auto size = announced_answer_size(output);
        return size && output.size() > *size;
    };
    ChildResult result = run_child(program, request, options.timeout_seconds, is_garbage);
    require_success(result, program.string(), options.timeout_seconds);
    return {"answer of " + program.string(), std::move(result.output)};
}

TetMesh to_mesh(const Reply& reply) {
    TetMesh mesh = decode_answer(reply.bytes, reply.place);
    validate_answer(mesh, reply.place);
    orient_cells(mesh);
    return mesh;
}

}  // namespace

std::filesystem::path find_mesher() {
    const char* named = std::getenv("CELLPROJ_MESHER");
    if (named && *named) {
        if (is_program(named)) return named;
        throw Error({.kind = ErrorKind::environment,
                     .place = "environment variable CELLPROJ_MESHER",
                     .expected = "the path of the program cellproj-mesher",
                     .found = std::string("\"") + named + "\", which is no program",
                     .advice = "correct the variable, or unset it to search the usual places"});
    }
    for (const std::filesystem::path& candidate : mesher_candidates()) {
        if (is_program(candidate)) return candidate;
    }
    throw Error({.kind = ErrorKind::environment,
                 .place = mesher_name,
                 .expected = "the program beside this one, in ../libexec/cellproj, or on PATH",
                 .found = "none",
                 .advice = "build cellproj with CELLPROJ_WITH_MESHER=ON, or name the program in CELLPROJ_MESHER"});
}

TetMesh tetrahedralize(const PiecewiseLinearComplex& complex, const MesherOptions& options) {
    validate(options);
    validate(complex, "piecewise-linear complex");
    return to_mesh(ask(encode_request(complex, options.max_volume, options.radius_edge_ratio), options));
}

TetMesh tetrahedralize(const Surface& surface, const MesherOptions& options, SurfaceReport* report) {
    validate(options);
    validate(surface);
    if (options.fill_holes && surface.inside == Inside::enclosed) {
        throw Error({.kind = ErrorKind::option,
                     .place = "mesher option fill_holes",
                     .expected = "a surface that is a closed boundary but for some holes",
                     .found = surface.name + ", which may have inner walls",
                     .advice = "leave out either the filling of open ends or the seeds of holes and regions"});
    }
    SurfaceRequest request{surface, options.fill_holes, options.max_volume, options.radius_edge_ratio, options.wrap};
    request.surface.point_fields.clear();
    const Reply reply = ask(encode_request(request), options);
    if (is_refusal(reply.bytes)) {
        Refusal refusal = decode_refusal(reply.bytes, reply.place, surface.name);
        if (report) report->intersections = std::move(refusal.intersections);
        throw Error(std::move(refusal.error));
    }
    if (report) report->intersections.clear();
    TetMesh mesh = to_mesh(reply);
    carry_fields(surface, mesh);
    return mesh;
}

}  // namespace cellproj
