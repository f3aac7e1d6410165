// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/mesher_format.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

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

class Writer {
public:
    template <class T>
    void value(const T& number) {
        static_assert(std::is_trivially_copyable_v<T>);
        body_.append(reinterpret_cast<const char*>(&number), sizeof(T));
    }

    template <class T>
    void array(const std::vector<T>& numbers) {
        static_assert(std::is_trivially_copyable_v<T>);
        body_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
    }

    void text(const std::string& words) {
        value(std::uint64_t{words.size()});
        body_ += words;
    }

    std::string message(Kind kind) const {
        Writer header;
        header.body_ = magic;
        header.value(version);
        header.value(kind);
        header.value(std::uint64_t{body_.size()});
        return std::move(header.body_) + body_;
    }

private:
    std::string body_;
};

class Reader {
public:
    Reader(std::string_view bytes, const std::string& place) : bytes_(bytes), place_(place) {}

    [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
        throw Error({.kind = ErrorKind::mesher,
                     .place = place_,
                     .expected = expected,
                     .found = found,
                     .advice = "cellproj and cellproj-mesher must be of the same version"});
    }

    template <class T>
    T value(const char* what) {
        return array<T>(1, what).front();
    }

    template <class T>
    std::vector<T> array(std::uint64_t count, const char* what) {
        static_assert(std::is_trivially_copyable_v<T>);
        // Compared by division: a count from outside may overflow when multiplied.
        if (count > bytes_.size() / sizeof(T)) {
            fail(std::to_string(count) + " × " + std::to_string(sizeof(T)) + " bytes of " + what,
                 std::to_string(bytes_.size()) + " bytes");
        }
        std::vector<T> numbers(static_cast<std::size_t>(count));
        if (count > 0) std::memcpy(numbers.data(), bytes_.data(), numbers.size() * sizeof(T));
        bytes_.remove_prefix(numbers.size() * sizeof(T));
        return numbers;
    }

    std::string text(const char* what) {
        const auto letters = array<char>(value<std::uint64_t>("length"), what);
        return {letters.begin(), letters.end()};
    }

    void header(Kind expected) {
        const std::string_view start = bytes_.substr(0, magic.size());
        if (start != magic)
            fail("a message that starts with \"cpmesher\"", std::to_string(bytes_.size()) + " other bytes");
        bytes_.remove_prefix(magic.size());
        if (const auto v = value<std::uint32_t>("version"); v != version) {
            fail("version " + std::to_string(version) + " of the exchange format", "version " + std::to_string(v));
        }
        if (const auto kind = value<std::uint32_t>("kind"); kind != static_cast<std::uint32_t>(expected)) {
            fail(in_words(expected), "kind " + std::to_string(kind));
        }
        if (const auto size = value<std::uint64_t>("body size"); size != bytes_.size()) {
            fail("a body of " + std::to_string(size) + " bytes", std::to_string(bytes_.size()) + " bytes");
        }
    }

    void end() const {
        if (!bytes_.empty()) fail("the end of the message", std::to_string(bytes_.size()) + " more bytes");
    }

private:
    std::string_view bytes_;
    const std::string& place_;
};

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// All polygons in two arrays.
struct FlatPolygons {
    std::vector<std::uint32_t> sizes;
    std::vector<VertexId> vertices;
};

FlatPolygons flatten(const std::vector<std::vector<VertexId>>& polygons) {
    FlatPolygons flat;
    for (const std::vector<VertexId>& polygon : polygons) {
        flat.sizes.push_back(static_cast<std::uint32_t>(polygon.size()));
        flat.vertices.insert(flat.vertices.end(), polygon.begin(), polygon.end());
    }
    return flat;
}

std::vector<std::vector<VertexId>> split_facets(const std::vector<std::uint32_t>& sizes,
                                                const std::vector<VertexId>& vertices, const Reader& reader) {
    std::vector<std::vector<VertexId>> facets;
    facets.reserve(sizes.size());
    std::size_t first = 0;
    for (const std::size_t size : sizes) {
        if (size > vertices.size() - first)
            reader.fail("facet sizes that add up", "more facet vertices than were sent");
        const auto begin = vertices.begin() + static_cast<std::ptrdiff_t>(first);
        facets.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(size));
        first += size;
    }
    if (first != vertices.size()) reader.fail("facet sizes that add up", "fewer facet vertices than were sent");
    return facets;
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
    const auto [sizes, vertices] = flatten(complex.facets);
    Writer writer;
    writer.value(max_volume);
    writer.value(radius_edge_ratio);
    writer.value(std::uint64_t{complex.points.size()});
    writer.value(std::uint64_t{sizes.size()});
    writer.value(std::uint64_t{vertices.size()});
    writer.value(std::uint64_t{complex.holes.size()});
    writer.value(std::uint64_t{complex.regions.size()});
    writer.array(complex.points);
    writer.array(sizes);
    writer.array(vertices);
    writer.array(complex.holes);
    writer.array(complex.regions);
    return writer.message(Kind::request);
}

MeshingRequest decode_request(std::string_view message, const std::string& place) {
    Reader reader(message, place);
    reader.header(Kind::request);
    MeshingRequest request;
    request.max_volume = reader.value<double>("largest volume");
    request.radius_edge_ratio = reader.value<double>("radius-edge ratio");
    const auto counts = reader.array<std::uint64_t>(5, "counts");
    request.complex.points = reader.array<glm::dvec3>(counts[0], "points");
    const auto sizes = reader.array<std::uint32_t>(counts[1], "facet sizes");
    const auto vertices = reader.array<VertexId>(counts[2], "facet vertices");
    request.complex.facets = split_facets(sizes, vertices, reader);
    request.complex.holes = reader.array<glm::dvec3>(counts[3], "holes");
    request.complex.regions = reader.array<Region>(counts[4], "regions");
    reader.end();
    return request;
}

std::string encode_request(const SurfaceRequest& request) {
    const auto [sizes, vertices] = flatten(request.surface.polygons);
    Writer writer;
    writer.value(request.max_volume);
    writer.value(request.radius_edge_ratio);
    writer.value(std::uint64_t{request.fill_holes});
    writer.value(std::uint64_t{request.surface.points.size()});
    writer.value(std::uint64_t{sizes.size()});
    writer.value(std::uint64_t{vertices.size()});
    writer.array(request.surface.points);
    writer.array(sizes);
    writer.array(vertices);
    writer.value(request.wrap);
    writer.value(static_cast<std::uint64_t>(request.surface.inside));
    writer.value(std::uint64_t{request.surface.facets.size()});
    writer.value(std::uint64_t{request.surface.holes.size()});
    writer.value(std::uint64_t{request.surface.regions.size()});
    writer.array(request.surface.facets);
    writer.array(request.surface.holes);
    writer.array(request.surface.regions);
    return writer.message(Kind::surface_request);
}

SurfaceRequest decode_surface_request(std::string_view message, const std::string& place) {
    Reader reader(message, place);
    reader.header(Kind::surface_request);
    SurfaceRequest request;
    request.surface.name = place;
    request.max_volume = reader.value<double>("largest volume");
    request.radius_edge_ratio = reader.value<double>("radius-edge ratio");
    const auto counts = reader.array<std::uint64_t>(4, "counts");
    request.fill_holes = counts[0] != 0;
    request.surface.points = reader.array<glm::dvec3>(counts[1], "points");
    const auto sizes = reader.array<std::uint32_t>(counts[2], "polygon sizes");
    const auto vertices = reader.array<VertexId>(counts[3], "polygon vertices");
    request.surface.polygons = split_facets(sizes, vertices, reader);
    request.wrap = reader.value<double>("wrap");
    const auto more = reader.array<std::uint64_t>(4, "counts");
    request.surface.inside = more[0] == 0 ? Inside::alternating : Inside::enclosed;
    request.surface.facets = reader.array<std::uint32_t>(more[1], "facets");
    request.surface.holes = reader.array<glm::dvec3>(more[2], "holes");
    request.surface.regions = reader.array<Region>(more[3], "regions");
    reader.end();
    return request;
}

bool is_surface_request(std::string_view message) {
    return is_of(Kind::surface_request, message);
}

bool is_refusal(std::string_view message) {
    return is_of(Kind::refusal, message);
}

std::string encode_refusal(const Refusal& refusal) {
    Writer writer;
    writer.text(refusal.error.expected());
    writer.text(refusal.error.found());
    writer.text(refusal.error.advice());
    writer.value(std::uint64_t{refusal.intersections.size()});
    writer.array(refusal.intersections);
    return writer.message(Kind::refusal);
}

Refusal decode_refusal(std::string_view message, const std::string& place, const std::string& subject) {
    Reader reader(message, place);
    reader.header(Kind::refusal);
    ErrorParts parts{.kind = ErrorKind::data, .place = subject, .expected = {}, .found = {}, .advice = {}};
    parts.expected = reader.text("expectation");
    parts.found = reader.text("finding");
    parts.advice = reader.text("advice");
    const auto pairs = reader.value<std::uint64_t>("a count");
    auto intersections = reader.array<std::array<std::uint32_t, 2>>(pairs, "pairs of facets");
    reader.end();
    return {Error(std::move(parts)), std::move(intersections)};
}

std::string encode_answer(const TetMesh& mesh) {
    static const std::vector<double> none;
    const Field* region = region_field(mesh);
    const std::vector<double>& attributes = region ? region->values : none;
    Writer writer;
    writer.value(std::uint64_t{mesh.points.size()});
    writer.value(std::uint64_t{mesh.tets.size()});
    writer.value(std::uint64_t{attributes.size()});
    writer.array(mesh.points);
    writer.array(mesh.tets);
    writer.array(attributes);
    return writer.message(Kind::answer);
}

TetMesh decode_answer(std::string_view message, const std::string& place) {
    Reader reader(message, place);
    reader.header(Kind::answer);
    TetMesh mesh;
    const auto counts = reader.array<std::uint64_t>(3, "counts");
    mesh.points = reader.array<glm::dvec3>(counts[0], "points");
    mesh.tets = reader.array<std::array<VertexId, 4>>(counts[1], "tets");
    if (counts[2] != 0) {
        if (counts[2] != counts[1]) reader.fail("one region attribute per cell", std::to_string(counts[2]));
        mesh.cell_fields.push_back({"region", 1, reader.array<double>(counts[2], "region attributes")});
    }
    reader.end();
    return mesh;
}

std::optional<std::size_t> announced_answer_size(std::string_view start) {
    if (start.substr(0, magic.size()) != magic.substr(0, start.size())) return 0;
    if (start.size() < header_size) return std::nullopt;
    std::uint64_t body = 0;
    std::memcpy(&body, start.data() + header_size - sizeof(body), sizeof(body));
    return body > std::numeric_limits<std::size_t>::max() - header_size ? 0 : header_size + body;
}

}  // namespace cellproj
