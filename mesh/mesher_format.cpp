// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesher_format.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/io/byte_stream.hpp"
#include "mesh/error.hpp"

namespace cellproj {

namespace {

constexpr std::string_view magic = "cpmesher";
constexpr std::uint32_t version = 3;
constexpr std::size_t header_size = 8 + 4 + 4 + 8;

enum class Kind : std::uint32_t { request = 1, answer = 2, surface_request = 3, refusal = 4 };

const char* in_words(Kind kind) {
    switch (kind) {
        case Kind::request:
            return "a request (kind 1)";
        case Kind::answer:
            return "an answer (kind 2)";
        case Kind::surface_request:
            return "a surface request (kind 3)";
        case Kind::refusal:
            break;
    }
    return "a refusal (kind 4)";
}

bool is_of(Kind kind, std::string_view message) {
    std::uint32_t found = 0;
    if (message.size() < header_size || !message.starts_with(magic)) return false;
    std::memcpy(&found, message.data() + magic.size() + sizeof(version), sizeof(found));
    return found == static_cast<std::uint32_t>(kind);
}

// TetGen numbers with int and addresses three coordinates per point with them.
constexpr std::size_t max_mesher_points = std::numeric_limits<std::int32_t>::max() / 4;

static_assert(sizeof(glm::dvec3) == 24 && sizeof(Region) == 40 && sizeof(std::array<VertexId, 4>) == 16,
              "the format stores these structs as they lie in memory");

// The message of a kind whose body `fill` writes.
template <class Fill>
std::string make_message(Kind kind, Fill fill) {
    std::string message;
    ByteWriter writer([&](std::string_view bytes) { message += bytes; });
    message += magic;
    writer.value(version);
    writer.value(kind);
    writer.value(std::uint64_t{0});
    fill(writer);
    const std::uint64_t body = message.size() - header_size;
    std::memcpy(message.data() + header_size - sizeof(body), &body, sizeof(body));
    return message;
}

// What `take` makes of the body of a message of this kind, all of it.
template <class Take>
auto take_message(std::string_view message, Kind kind, const std::string& place, Take take) {
    const auto fail = [&](const std::string& expected, const std::string& found) {
        throw Error({.kind = ErrorKind::mesher,
                     .place = place,
                     .expected = expected,
                     .found = found,
                     .advice = "cellproj and cellproj-mesher must be of the same version"});
    };
    if (!message.starts_with(magic))
        fail("a message that starts with \"cpmesher\"", std::to_string(message.size()) + " other bytes");
    ByteReader reader(message.substr(magic.size()), fail);
    if (const auto found = reader.value<std::uint32_t>("version"); found != version)
        fail("version " + std::to_string(version) + " of the exchange format", "version " + std::to_string(found));
    if (const auto found = reader.value<Kind>("kind"); found != kind)
        fail(in_words(kind), "kind " + std::to_string(static_cast<std::uint32_t>(found)));
    if (const auto size = reader.value<std::uint64_t>("body size"); size != reader.left())
        fail("a body of " + std::to_string(size) + " bytes", std::to_string(reader.left()) + " bytes");
    auto result = take(reader);
    if (reader.left() > 0) fail("the end of the message", std::to_string(reader.left()) + " more bytes");
    return result;
}

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

const Field* region_field(const TetMesh& mesh) {
    for (const Field& field : mesh.cell_fields) {
        if (field.name == "region" && field.components == 1) return &field;
    }
    return nullptr;
}

}  // namespace

void validate(const PiecewiseLinearComplex& complex, const std::string& place) {
    const std::size_t count = complex.points.size();
    const auto refuse = [&](const std::string& expected, const std::string& found, const std::string& advice) {
        throw Error({.kind = ErrorKind::data, .place = place, .expected = expected, .found = found, .advice = advice});
    };
    if (count < 4 || count > max_mesher_points) {
        refuse("4 to " + std::to_string(max_mesher_points) + " points", std::to_string(count) + " points",
               "give a closed surface");
    }
    const auto require_finite = [&](const glm::dvec3& p, const std::string& what, std::size_t i) {
        if (!finite(p))
            refuse("finite coordinates", what + " " + std::to_string(i) + " is not finite", "repair or remove it");
    };
    for (std::size_t i = 0; i < count; ++i)
        require_finite(complex.points[i], "point", i);
    for (std::size_t i = 0; i < complex.holes.size(); ++i)
        require_finite(complex.holes[i], "the seed of hole", i);
    for (std::size_t i = 0; i < complex.regions.size(); ++i) {
        const Region& region = complex.regions[i];
        require_finite(region.seed, "the seed of region", i);
        require_finite({region.attribute, region.max_volume, 0.0}, "the attribute or volume of region", i);
    }
    for (std::size_t f = 0; f < complex.facets.size(); ++f) {
        const std::vector<VertexId>& facet = complex.facets[f];
        const std::string which = "facet " + std::to_string(f);
        if (facet.size() < 3) {
            refuse("facets of at least 3 vertices", which + " with " + std::to_string(facet.size()), "remove it");
        }
        for (const VertexId v : facet) {
            if (v < count) continue;
            refuse("vertex ids below " + std::to_string(count), which + " with id " + std::to_string(v),
                   "ids count from 0");
        }
    }
}

std::string encode_request(const PiecewiseLinearComplex& complex, double max_volume, double radius_edge_ratio) {
    return make_message(Kind::request, [&](ByteWriter& writer) {
        writer.value(max_volume);
        writer.value(radius_edge_ratio);
        writer.array(complex.points);
        writer.lists(complex.facets);
        writer.array(complex.holes);
        writer.array(complex.regions);
    });
}

MeshingRequest decode_request(std::string_view message, const std::string& place) {
    return take_message(message, Kind::request, place, [](ByteReader& reader) {
        MeshingRequest request;
        request.max_volume = reader.value<double>("largest volume");
        request.radius_edge_ratio = reader.value<double>("radius-edge ratio");
        request.complex.points = reader.array<glm::dvec3>("points");
        request.complex.facets = reader.lists<VertexId>("facets");
        request.complex.holes = reader.array<glm::dvec3>("holes");
        request.complex.regions = reader.array<Region>("regions");
        return request;
    });
}

std::string encode_request(const SurfaceRequest& request) {
    return make_message(Kind::surface_request, [&](ByteWriter& writer) {
        writer.value(request.max_volume);
        writer.value(request.radius_edge_ratio);
        writer.value(std::uint64_t{request.fill_holes});
        writer.value(request.wrap);
        writer.value(static_cast<std::uint64_t>(request.surface.inside));
        writer.array(request.surface.points);
        writer.lists(request.surface.polygons);
        writer.array(request.surface.facets);
        writer.array(request.surface.holes);
        writer.array(request.surface.regions);
    });
}

SurfaceRequest decode_surface_request(std::string_view message, const std::string& place) {
    return take_message(message, Kind::surface_request, place, [&](ByteReader& reader) {
        SurfaceRequest request;
        request.surface.name = place;
        request.max_volume = reader.value<double>("largest volume");
        request.radius_edge_ratio = reader.value<double>("radius-edge ratio");
        request.fill_holes = reader.value<std::uint64_t>("choice to fill holes") != 0;
        request.wrap = reader.value<double>("wrap");
        request.surface.inside =
            reader.value<std::uint64_t>("what is inside") == 0 ? Inside::alternating : Inside::enclosed;
        request.surface.points = reader.array<glm::dvec3>("points");
        request.surface.polygons = reader.lists<VertexId>("polygons");
        request.surface.facets = reader.array<std::uint32_t>("facets");
        request.surface.holes = reader.array<glm::dvec3>("holes");
        request.surface.regions = reader.array<Region>("regions");
        return request;
    });
}

bool is_surface_request(std::string_view message) {
    return is_of(Kind::surface_request, message);
}

bool is_refusal(std::string_view message) {
    return is_of(Kind::refusal, message);
}

std::string encode_refusal(const Refusal& refusal) {
    return make_message(Kind::refusal, [&](ByteWriter& writer) {
        writer.text(refusal.error.expected());
        writer.text(refusal.error.found());
        writer.text(refusal.error.advice());
        writer.array(refusal.intersections);
    });
}

Refusal decode_refusal(std::string_view message, const std::string& place, const std::string& subject) {
    return take_message(message, Kind::refusal, place, [&](ByteReader& reader) {
        ErrorParts parts{.kind = ErrorKind::data, .place = subject, .expected = {}, .found = {}, .advice = {}};
        parts.expected = reader.text("expectation");
        parts.found = reader.text("finding");
        parts.advice = reader.text("advice");
        auto intersections = reader.array<std::array<std::uint32_t, 2>>("pairs of facets");
        return Refusal{Error(parts), std::move(intersections)};
    });
}

std::string encode_answer(const TetMesh& mesh) {
    static const std::vector<double> none;
    const Field* region = region_field(mesh);
    return make_message(Kind::answer, [&](ByteWriter& writer) {
        writer.array(mesh.points);
        writer.array(mesh.tets);
        writer.array(region ? region->values : none);
    });
}

TetMesh decode_answer(std::string_view message, const std::string& place) {
    return take_message(message, Kind::answer, place, [](ByteReader& reader) {
        TetMesh mesh;
        mesh.points = reader.array<glm::dvec3>("points");
        mesh.tets = reader.array<std::array<VertexId, 4>>("tets");
        std::vector<double> attributes = reader.array<double>("region attributes");
        if (!attributes.empty() && attributes.size() != mesh.tets.size())
            reader.fail("one region attribute per cell", std::to_string(attributes.size()));
        if (!attributes.empty()) mesh.cell_fields.push_back({"region", 1, std::move(attributes)});
        return mesh;
    });
}

std::optional<std::size_t> announced_answer_size(std::string_view start) {
    if (start.substr(0, magic.size()) != magic.substr(0, start.size())) return 0;
    if (start.size() < header_size) return std::nullopt;
    std::uint64_t body = 0;
    std::memcpy(&body, start.data() + header_size - sizeof(body), sizeof(body));
    return body > std::numeric_limits<std::size_t>::max() - header_size ? 0 : header_size + body;
}

}  // namespace cellproj
