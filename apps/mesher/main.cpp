// SPDX-License-Identifier: AGPL-3.0-or-later
//
// cellproj-mesher: reads one request on standard input, meshes it with TetGen, writes one answer to standard output
// (mesh/mesher_format.hpp). Exit status 0, or 1 with one line on standard error, or 2 when called with arguments.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#define TETLIBRARY
#include <tetgen.h>

#include "mesh/error.hpp"
#include "mesh/mesher_format.hpp"
#include "repair.hpp"
#include "seeds.hpp"
#include "wrap.hpp"

namespace {

using namespace cellproj;

const char* tetgen_failure(int code) {
    switch (code) {
        case 1:
            return "TetGen ran out of memory";
        case 2:
            return "TetGen met an internal error";
        case 3:
            return "the surface intersects itself, TetGen says";
        case 4:
            return "the surface has a feature too small for TetGen's tolerance";
        case 5:
            return "two facets of the surface are too close to each other for TetGen";
        case 10:
            return "TetGen cannot use this surface as input";
        default:
            return "TetGen failed for an unknown reason";
    }
}

// Every failure ends here, uncaught on purpose: TetGen frees its memory before it throws and once more while the stack
// unwinds, and dies of that. An exception without a handler does not unwind with GCC; here it can still be told.
[[noreturn]] void report_and_exit() {
    try {
        if (const std::exception_ptr reason = std::current_exception()) std::rethrow_exception(reason);
        std::fputs("cellproj-mesher: stopped for an unknown reason\n", stderr);
    } catch (const int code) {
        std::fprintf(stderr, "cellproj-mesher: %s (code %d)\n", tetgen_failure(code), code);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cellproj-mesher: %s\n", error.what());
    } catch (...) {
        std::fputs("cellproj-mesher: stopped for an unknown reason\n", stderr);
    }
    std::_Exit(EXIT_FAILURE);
}

[[noreturn]] void fail_with_errno(const std::string& what) {
    throw std::runtime_error(what + ": " + std::strerror(errno));
}

// TetGen prints to standard output, which belongs to the answer: it goes elsewhere before TetGen is called.
int take_standard_output() {
    const int answer = dup(STDOUT_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (answer < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0) fail_with_errno("standard output");
    close(nowhere);
    return answer;
}

std::string read_all(int descriptor) {
    std::string bytes;
    std::vector<char> buffer(1 << 16);
    for (;;) {
        const ssize_t count = read(descriptor, buffer.data(), buffer.size());
        if (count == 0) return bytes;
        if (count > 0) {
            bytes.append(buffer.data(), static_cast<std::size_t>(count));
        } else if (errno != EINTR) {
            fail_with_errno("cannot read the request");
        }
    }
}

void write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = write(descriptor, bytes.data(), bytes.size());
        if (count >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(count));
        } else if (errno != EINTR) {
            fail_with_errno("cannot write the answer");
        }
    }
}

// tetgenio frees its lists with delete[]; each function below hands over arrays made for that.
REAL* coordinates(const std::vector<glm::dvec3>& points) {
    REAL* list = new REAL[3 * points.size()];
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (int axis = 0; axis < 3; ++axis)
            list[3 * i + static_cast<std::size_t>(axis)] = points[i][axis];
    }
    return list;
}

void set_facets(tetgenio& io, const std::vector<std::vector<VertexId>>& facets) {
    io.facetlist = new tetgenio::facet[facets.size()];
    for (const std::vector<VertexId>& vertices : facets) {
        tetgenio::facet& facet = io.facetlist[io.numberoffacets++];
        tetgenio::init(&facet);
        facet.polygonlist = new tetgenio::polygon[1];
        facet.numberofpolygons = 1;
        facet.polygonlist->vertexlist = new int[vertices.size()];
        facet.polygonlist->numberofvertices = static_cast<int>(vertices.size());
        std::copy(vertices.begin(), vertices.end(), facet.polygonlist->vertexlist);
    }
}

void set_regions(tetgenio& io, const std::vector<Region>& regions) {
    io.regionlist = new REAL[5 * regions.size()];
    io.numberofregions = static_cast<int>(regions.size());
    REAL* entry = io.regionlist;
    for (const Region& region : regions) {
        // TetGen reads a bound that is not positive as none.
        const std::array<REAL, 5> numbers{region.seed.x, region.seed.y, region.seed.z, region.attribute,
                                          region.max_volume > 0.0 ? region.max_volume : -1.0};
        entry = std::copy(numbers.begin(), numbers.end(), entry);
    }
}

void set_complex(tetgenio& io, const PiecewiseLinearComplex& complex) {
    io.pointlist = coordinates(complex.points);
    io.numberofpoints = static_cast<int>(complex.points.size());
    set_facets(io, complex.facets);
    io.holelist = coordinates(complex.holes);
    io.numberofholes = static_cast<int>(complex.holes.size());
    set_regions(io, complex.regions);
}

std::string switch_with_number(char name, double number) {
    std::array<char, 40> text;
    std::snprintf(text.data(), text.size(), "%c%.17g", name, number);
    return text.data();
}

// p: a piecewise-linear complex; Q: quiet; A: regions are numbered or keep their attributes; a: volume bounds of
// regions; aV: of all; qR: radius-edge ratio; O0: no optimization of the finished mesh, whose flips break bounds that
// refinement kept (one cell in a few thousand came out up to 15 % too large). "a" without a number must not stand
// before a digit.
std::string tetgen_switches(const MeshingRequest& request, bool number_regions) {
    const auto bounded = [](const Region& region) { return region.max_volume > 0.0; };
    const std::vector<Region>& regions = request.complex.regions;
    const bool region_bounds = std::any_of(regions.begin(), regions.end(), bounded);
    std::string switches = "p";
    if (region_bounds) switches += 'a';
    switches += 'Q';
    if (!regions.empty() || number_regions) switches += 'A';
    if (request.radius_edge_ratio > 0.0) switches += switch_with_number('q', request.radius_edge_ratio);
    if (request.max_volume > 0.0) switches += switch_with_number('a', request.max_volume);
    if (region_bounds || request.radius_edge_ratio > 0.0 || request.max_volume > 0.0) switches += "O0";
    return switches;
}

TetMesh to_mesh(const tetgenio& io) {
    TetMesh mesh;
    for (int i = 0; i < io.numberofpoints; ++i) {
        const REAL* p = io.pointlist + 3 * static_cast<std::ptrdiff_t>(i);
        mesh.points.emplace_back(p[0], p[1], p[2]);
    }
    mesh.tets.resize(static_cast<std::size_t>(io.numberoftetrahedra));
    const int* corner = io.tetrahedronlist;
    for (std::array<VertexId, 4>& tet : mesh.tets) {
        for (VertexId& vertex : tet)
            vertex = static_cast<VertexId>(*corner++);
    }
    if (io.numberoftetrahedronattributes == 1) {
        const REAL* first = io.tetrahedronattributelist;
        mesh.cell_fields.push_back({"region", 1, std::vector<double>(first, first + io.numberoftetrahedra)});
    }
    return mesh;
}

TetMesh mesh_with_tetgen(const MeshingRequest& request, bool number_regions = false) {
    tetgenio in, out;
    set_complex(in, request.complex);
    std::string switches = tetgen_switches(request, number_regions);
    tetrahedralize(switches.data(), &in, &out);
    return to_mesh(out);
}

void require_bound(const char* name, double bound) {
    if (!std::isfinite(bound) || bound < 0.0)
        throw std::invalid_argument(std::string(name) + " must be finite and ≥ 0");
}

PiecewiseLinearComplex boundary_of(const SurfaceRequest& request, std::vector<std::array<std::uint32_t, 2>>& intersections) {
    const Surface& surface = request.surface;
    if (request.wrap > 0.0) return wrapped(surface, request.wrap);
    if (surface.inside == Inside::enclosed) return enclosing_facets(surface, intersections);
    return closed_boundary(surface, request.fill_holes, intersections);
}

// A crash while the surface is repaired ends as TetGen's do; only what is wrong with the surface is an answer.
std::string answer_surface(const std::string& message, const std::string& place) {
    const SurfaceRequest request = decode_surface_request(message, place);
    require_bound("max_volume", request.max_volume);
    require_bound("radius_edge_ratio", request.radius_edge_ratio);
    require_bound("wrap", request.wrap);
    MeshingRequest meshing{{}, request.max_volume, request.radius_edge_ratio};
    std::vector<std::array<std::uint32_t, 2>> intersections;
    try {
        validate(request.surface);
        meshing.complex = boundary_of(request, intersections);
    } catch (const Error& error) {
        return encode_refusal({error, std::move(intersections)});
    }
    meshing.complex.holes = request.surface.holes;
    if (!request.surface.regions.empty()) {
        const TetMesh parts = mesh_with_tetgen({meshing.complex, 0.0, 0.0}, true);
        try {
            require_seeds(parts, request.surface.regions, request.surface.name);
        } catch (const Error& error) {
            return encode_refusal({error, {}});
        }
        meshing.complex.regions = request.surface.regions;
    }
    const bool alternating = request.surface.inside == Inside::alternating;
    TetMesh mesh = mesh_with_tetgen(meshing, alternating);
    if (alternating) keep_inside(mesh, meshing.complex);
    return encode_answer(mesh);
}

std::string answer_complex(const std::string& message, const std::string& place) {
    const MeshingRequest request = decode_request(message, place);
    validate(request.complex, place);
    require_bound("max_volume", request.max_volume);
    require_bound("radius_edge_ratio", request.radius_edge_ratio);
    return encode_answer(mesh_with_tetgen(request));
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): see report_and_exit
int main(int argc, char** argv) {
    if (argc > 1) {
        std::fprintf(stderr, "%s takes no arguments: cellproj starts it and talks to it over its standard streams\n",
                     argv[0]);
        return 2;
    }
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody will read the answer of a mesher whose caller has died
#endif
    std::set_terminate(report_and_exit);
    const int answer = take_standard_output();
    const std::string request = read_all(STDIN_FILENO);
    const std::string place = "request on standard input";
    write_all(answer, is_surface_request(request) ? answer_surface(request, place) : answer_complex(request, place));
    return 0;
}
