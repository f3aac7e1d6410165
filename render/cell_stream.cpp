// SPDX-License-Identifier: BSD-3-Clause
#include "render/cell_stream.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include <glm/common.hpp>

namespace cellproj {

namespace {

// Nearest depth that is drawn, in SceneUnits::length. What lies before it is a millionth of the mesh.
constexpr double near_depth = 1e-6;

// Rasterizers snap vertices to 1/256 of a pixel: how far outside its exact outline a triangle can cover pixel centres.
constexpr double snap_margin = 1.0 / 128;

// How far beyond the picture triangles may reach, in pictures. Within it, float32 positions are good to 1e-6 of the picture.
constexpr double guard_pictures = 1.0;

// The camera with lengths in the units of the scene, relative to its eye: large coordinates cancel in float64, once.
ScreenTransform relative_transform(const Camera& camera, ImageSize size, double length) {
    Camera relative = camera;
    relative.center = (camera.center - camera.eye) / length;
    relative.eye = glm::dvec3(0.0);
    relative.height = camera.height / length;
    return {relative, size};
}

bool corners_inside(const ProjectedTet& tet, const Rectangle& r) {
    return std::all_of(tet.vertices.begin(), tet.vertices.begin() + 4, [&](const ProjectedVertex& v) {
        return v.position.x >= r.low.x && v.position.x <= r.high.x && v.position.y >= r.low.y &&
               v.position.y <= r.high.y;
    });
}

}  // namespace

CellStream::CellStream(const PreparedScene& prepared, const Camera& camera, ImageSize size)
    : prepared_(prepared), eye_(camera.eye), transform_(relative_transform(camera, size, prepared.units().length)) {
    const glm::dvec2 picture(size.width, size.height);
    guard_ = {-guard_pictures * picture, (1 + guard_pictures) * picture};

    const auto& [mesh, field] = std::tie(*prepared.scene().mesh, *prepared.scene().field);
    const SceneUnits& units = prepared.units();
    points_.resize(mesh.points.size());
    scalars_.resize(field.values.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, points_.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const glm::dvec3 p = transform_.to_eye((mesh.points[i] - eye_) / units.length);
            const bool behind = transform_.perspective() && p.z <= near_depth;
            const double depth = transform_.perspective() ? 1.0 / p.z : p.z;
            points_[i] = behind ? ScreenPoint{{}, 0.0} : ScreenPoint{transform_.to_screen(p), depth};
        }
    });
    oneapi::tbb::parallel_for(Range(0, scalars_.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) scalars_[i] = units.normalized(field.values[i]);
    });
}

void CellStream::project(std::span<const CellId> cells, TriangleBatch& batch) const {
    const auto& visible = prepared_.visible();
    for (const CellId cell : cells) {
        if (!visible[cell]) continue;
        Corners corners;
        const bool drawn = load(cell, corners) ? project_corners(corners, batch) : project_clipped(cell, batch);
        if (drawn) ++batch.drawn_cells;
    }
}

ScreenVertex CellStream::on_screen(const glm::dvec3& p, double scalar) const {
    if (!transform_.perspective()) return {transform_.to_screen(p), p.z, scalar};
    const double inverse = 1.0 / p.z;
    return {transform_.to_screen(p), inverse, scalar * inverse};
}

// False when a corner lies behind the near plane.
bool CellStream::load(CellId cell, Corners& corners) const {
    const auto& tet = prepared_.scene().mesh->tets[cell];
    const bool per_point = prepared_.scene().field->location == FieldLocation::points;
    for (std::size_t i = 0; i < 4; ++i) {
        const ScreenPoint& p = points_[tet[i]];
        const double scalar = scalars_[per_point ? tet[i] : cell];
        if (transform_.perspective() && p.depth == 0.0) return false;
        corners[i] = {p.position, p.depth, transform_.perspective() ? scalar * p.depth : scalar};
    }
    return true;
}

bool CellStream::project_clipped(CellId cell, TriangleBatch& batch) const {
    const TetMesh& mesh = *prepared_.scene().mesh;
    const bool per_point = prepared_.scene().field->location == FieldLocation::points;
    std::array<EyeVertex, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
        const VertexId v = mesh.tets[cell][i];
        corners[i] = {transform_.to_eye((mesh.points[v] - eye_) / prepared_.units().length), scalars_[per_point ? v : cell]};
    }
    const ClippedTet pieces = clip_near(corners, near_depth);
    bool drawn = false;
    for (std::size_t piece = 0; piece < pieces.count; ++piece) {
        Corners screen;
        for (std::size_t i = 0; i < 4; ++i) {
            screen[i] = on_screen(pieces.tets[piece][i].position, pieces.tets[piece][i].scalar);
        }
        drawn |= project_corners(screen, batch);
    }
    return drawn;
}

bool CellStream::project_corners(const Corners& corners, TriangleBatch& batch) const {
    glm::dvec2 low = corners[0].position, high = low;
    for (std::size_t i = 1; i < 4; ++i) {
        low = glm::min(low, corners[i].position);
        high = glm::max(high, corners[i].position);
    }
    if (!covers_pixel(low, high)) return false;
    const ProjectedTet tet = project_tet(corners, transform_.perspective());
    if (tet.kind == ProjectionClass::nothing) return false;
    const CellBounds bounds = cell_bounds(corners);
    if (corners_inside(tet, guard_)) {
        append(tet, bounds, batch);
    } else {
        append_clipped(tet, bounds, batch);
    }
    return true;
}

// Whether the box holds a pixel centre of the picture.
bool CellStream::covers_pixel(const glm::dvec2& low, const glm::dvec2& high) const {
    const glm::dvec2 picture(transform_.size().width, transform_.size().height);
    const glm::dvec2 first = glm::max(glm::ceil(low - 0.5 - snap_margin), glm::dvec2(0.0));
    const glm::dvec2 last = glm::min(glm::floor(high - 0.5 + snap_margin), picture - 1.0);
    return first.x <= last.x && first.y <= last.y;
}

CellStream::CellBounds CellStream::cell_bounds(const Corners& corners) const {
    const bool perspective = transform_.perspective();
    const auto depth = [&](const ScreenVertex& v) { return perspective ? 1.0 / v.depth : v.depth; };
    const auto scalar = [&](const ScreenVertex& v) { return perspective ? v.scalar / v.depth : v.scalar; };
    double near = depth(corners[0]), far = near, low = scalar(corners[0]), high = low;
    for (std::size_t i = 1; i < 4; ++i) {
        near = std::min(near, depth(corners[i]));
        far = std::max(far, depth(corners[i]));
        low = std::min(low, scalar(corners[i]));
        high = std::max(high, scalar(corners[i]));
    }
    return {static_cast<float>(low), static_cast<float>(high), static_cast<float>(far - near)};
}

StreamVertex CellStream::stream_vertex(const ProjectedVertex& v, const CellBounds& bounds) const {
    const ImageSize size = transform_.size();
    return {static_cast<float>(2 * v.position.x / size.width - 1),
            static_cast<float>(2 * v.position.y / size.height - 1),
            static_cast<float>(v.front_depth),
            static_cast<float>(v.thickness),
            static_cast<float>(v.front_scalar),
            static_cast<float>(v.back_scalar),
            bounds.scalar_low,
            bounds.scalar_high,
            bounds.depth_range};
}

void CellStream::append(const ProjectedTet& tet, const CellBounds& bounds, TriangleBatch& batch) const {
    const auto base = static_cast<std::uint32_t>(batch.vertices.size());
    for (std::size_t v = 0; v < tet.vertex_count(); ++v) batch.vertices.push_back(stream_vertex(tet.vertices[v], bounds));
    for (std::size_t t = 0; t < tet.triangle_count(); ++t) {
        for (const std::uint8_t corner : tet.triangles[t]) batch.indices.push_back(base + corner);
    }
}

void CellStream::append_clipped(const ProjectedTet& tet, const CellBounds& bounds, TriangleBatch& batch) const {
    for (std::size_t t = 0; t < tet.triangle_count(); ++t) {
        const auto& [a, b, c] = tet.triangles[t];
        const ClippedPolygon polygon = clip_to_rectangle({tet.vertices[a], tet.vertices[b], tet.vertices[c]}, guard_);
        const auto base = static_cast<std::uint32_t>(batch.vertices.size());
        for (std::size_t v = 0; v < polygon.count; ++v) {
            batch.vertices.push_back(stream_vertex(polygon.vertices[v], bounds));
        }
        for (std::uint32_t v = 2; v < polygon.count; ++v) {
            batch.indices.insert(batch.indices.end(), {base, base + v - 1, base + v});
        }
    }
}

}  // namespace cellproj
