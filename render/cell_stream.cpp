// SPDX-License-Identifier: BSD-3-Clause
#include "render/cell_stream.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// Rasterizers snap vertices to a grid of 1/256 of a pixel (llvmpipe, and most GPUs). Doing it before anything is decided makes
// that harmless: the picture is then exact for a mesh whose points have moved by less than 1/512 of a pixel, the same for all
// cells at a point, and no pixel centre falls between what the projection and what the rasterizer takes a cell to cover.
constexpr double snaps_per_pixel = 256.0;

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

bool inside(const Rectangle& r, const glm::dvec2& low, const glm::dvec2& high) {
    return low.x >= r.low.x && low.y >= r.low.y && high.x <= r.high.x && high.y <= r.high.y;
}

}  // namespace

CellStream::CellStream(const PreparedScene& prepared, const Camera& camera, ImageSize size)
    : prepared_(prepared), eye_(camera.eye), transform_(relative_transform(camera, size, prepared.units().length)) {
    const double distance = glm::distance(camera.eye, camera.center) / prepared.units().length;
    near_depth_ = 1e-3 * std::min(distance, 1.0);
    const glm::dvec2 picture(size.width, size.height);
    guard_ = {-guard_pictures * picture, (1 + guard_pictures) * picture};

    const TetMesh& mesh = *prepared.scene().mesh;
    const ScalarField& field = *prepared.scene().field;
    const SceneUnits& units = prepared.units();
    points_.resize(mesh.points.size());
    scalars_.resize(field.values.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, points_.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const glm::dvec3 p = transform_.to_eye((mesh.points[i] - eye_) / units.length);
            const bool behind = transform_.perspective() && p.z <= near_depth_;
            const double depth = transform_.perspective() ? 1.0 / p.z : p.z;
            points_[i] = behind ? ScreenPoint{{}, 0.0} : ScreenPoint{snapped_position(p), depth};
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

glm::dvec2 CellStream::snapped_position(const glm::dvec3& eye_point) const {
    return glm::round(transform_.to_screen(eye_point) * snaps_per_pixel) / snaps_per_pixel;
}

ScreenVertex CellStream::on_screen(const glm::dvec3& p, double scalar) const {
    if (!transform_.perspective()) return {snapped_position(p), p.z, scalar};
    const double inverse = 1.0 / p.z;
    return {snapped_position(p), inverse, scalar * inverse};
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
    const ClippedTet pieces = clip_near(corners, near_depth_);
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
    const Silhouette silhouette = make_silhouette(corners, transform_.perspective());
    if (silhouette.triangle_count == 0) return false;

    const StreamVertex constants = cell_constants(corners, silhouette);
    const auto base = static_cast<std::uint32_t>(batch.vertices.size());
    if (inside(guard_, low, high)) {
        for (const SilhouetteVertex& v : silhouette.vertices) batch.vertices.push_back(stream_vertex(v, constants));
        for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
            for (const std::uint8_t corner : silhouette.triangles[t]) batch.indices.push_back(base + corner);
        }
        return true;
    }
    for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
        const auto& [a, b, c] = silhouette.triangles[t];
        const auto& v = silhouette.vertices;
        const ClippedPolygon polygon = clip_to_rectangle({v[a], v[b], v[c]}, guard_);
        const auto first = static_cast<std::uint32_t>(batch.vertices.size());
        for (std::size_t i = 0; i < polygon.count; ++i) {
            batch.vertices.push_back(stream_vertex(polygon.vertices[i], constants));
        }
        for (std::uint32_t i = 2; i < polygon.count; ++i) {
            batch.indices.insert(batch.indices.end(), {first, first + i - 1, first + i});
        }
    }
    return true;
}

// Whether the box holds a pixel centre of the picture.
bool CellStream::covers_pixel(const glm::dvec2& low, const glm::dvec2& high) const {
    const glm::dvec2 picture(transform_.size().width, transform_.size().height);
    const glm::dvec2 first = glm::max(glm::ceil(low - 0.5), glm::dvec2(0.0));
    const glm::dvec2 last = glm::min(glm::floor(high - 0.5), picture - 1.0);
    return first.x <= last.x && first.y <= last.y;
}

// The part of a vertex that is equal for a whole cell.
StreamVertex CellStream::cell_constants(const Corners& corners, const Silhouette& silhouette) const {
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
    // A ray that enters at the near plane counts from the eye on.
    if (perspective && near <= near_depth_ * 1.0001) near = 0.0;
    StreamVertex constants{};
    constants.scalar_slope = static_cast<float>(silhouette.scalar_slope);
    constants.scalar_low = static_cast<float>(low);
    constants.scalar_high = static_cast<float>(high);
    constants.depth_range = static_cast<float>(silhouette.base_is_front ? far - near : near - far);
    return constants;
}

StreamVertex CellStream::stream_vertex(const SilhouetteVertex& v, const StreamVertex& constants) const {
    const ImageSize size = transform_.size();
    StreamVertex out = constants;
    out.x = static_cast<float>(2 * v.position.x / size.width - 1);
    out.y = static_cast<float>(2 * v.position.y / size.height - 1);
    out.base_depth = static_cast<float>(v.base_depth);
    out.base_scalar = static_cast<float>(v.base_scalar);
    for (int ridge = 0; ridge < 3; ++ridge) out.ridges[ridge] = static_cast<float>(v.ridges[ridge]);
    return out;
}

}  // namespace cellproj
