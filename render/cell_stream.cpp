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
// that harmless: cells are those of a mesh whose points have moved by less than 1/512 of a pixel, the same for all cells at a
// point, and no pixel centre falls between what the projection and what the rasterizer takes a cell to cover. Scalars stay
// where they were (project/silhouette.hpp).
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

// Radiance in float32: what is brighter than this does not come through, so that sums over all cells of a ray stay finite.
constexpr double brightest_color = 1e30;

bool inside(const Rectangle& r, const Rectangle& box) {
    return box.low.x >= r.low.x && box.low.y >= r.low.y && box.high.x <= r.high.x && box.high.y <= r.high.y;
}

Rectangle bounding_box(const std::array<ScreenVertex, 4>& corners) {
    Rectangle box{corners[0].position, corners[0].position};
    for (std::size_t i = 1; i < 4; ++i) {
        box.low = glm::min(box.low, corners[i].position);
        box.high = glm::max(box.high, corners[i].position);
    }
    return box;
}

// Appends triangles, given by three indices into `vertices` each, as they are or cut to the guard rectangle.
template <class Corner, class Vertex, class Convert>
void append(std::span<const Corner> vertices, std::span<const std::array<std::uint8_t, 3>> triangles, bool cut,
            const Rectangle& guard, Triangles<Vertex>& batch, Convert convert) {
    auto first = static_cast<std::uint32_t>(batch.vertices.size());
    if (!cut) {
        for (const Corner& v : vertices) batch.vertices.push_back(convert(v));
        for (const auto& triangle : triangles) {
            for (const std::uint8_t corner : triangle) batch.indices.push_back(first + corner);
        }
        return;
    }
    for (const auto& [a, b, c] : triangles) {
        const auto polygon = clip_to_rectangle(std::array{vertices[a], vertices[b], vertices[c]}, guard);
        first = static_cast<std::uint32_t>(batch.vertices.size());
        for (std::size_t i = 0; i < polygon.count; ++i) batch.vertices.push_back(convert(polygon.vertices[i]));
        for (std::uint32_t i = 2; i < polygon.count; ++i) {
            batch.indices.insert(batch.indices.end(), {first, first + i - 1, first + i});
        }
    }
}

// A vertex of the classical split in float64, with what is interpolated.
struct LitCorner {
    glm::dvec2 position;
    double share;
    glm::dvec3 color;
};

LitCorner mix(const LitCorner& a, const LitCorner& b, double t) {
    return {a.position + t * (b.position - a.position), a.share + t * (b.share - a.share), a.color + t * (b.color - a.color)};
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
            points_[i] = behind ? ScreenPoint{{}, {}, 0.0} : on_screen(p);
        }
    });
    oneapi::tbb::parallel_for(Range(0, scalars_.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) scalars_[i] = units.normalized(field.values[i]);
    });
}

// Calls draw(corners) for every visible cell or, where it is split or cut by the near plane, for its pieces; it says whether
// anything was drawn.
template <class Vertex, class Draw>
void CellStream::for_each_piece(const ViewOrder& order, Triangles<Vertex>& batch, Draw draw) const {
    const auto& visible = prepared_.visible();
    const auto cells = static_cast<std::uint32_t>(visible.size());
    const auto draw_clipped = [&](const std::array<EyeVertex, 4>& corners) {
        const Pieces pieces = clipped(corners);
        bool drawn = false;
        for (std::size_t piece = 0; piece < pieces.count; ++piece) drawn |= draw(pieces.corners[piece]);
        return drawn;
    };
    for (const std::uint32_t item : order.items) {
        if (item >= cells) {
            const CellPiece& piece = order.pieces[item - cells];
            if (visible[piece.cell] && draw_clipped(eye_corners(piece))) batch.drawn_split_cells.push_back(piece.cell);
            continue;
        }
        if (!visible[item]) continue;
        Corners corners;
        if (load(item, corners) ? draw(corners) : draw_clipped(eye_corners(item))) ++batch.drawn_cells;
    }
}

void CellStream::project(const ViewOrder& order, TriangleBatch& batch) const {
    for_each_piece(order, batch, [&](const Corners& corners) { return project_corners(corners, batch); });
}

void CellStream::project(const ViewOrder& order, const VertexLighting& lighting, LitBatch& batch) const {
    for_each_piece(order, batch, [&](const Corners& corners) { return light_corners(corners, lighting, batch); });
}

CellStream::ScreenPoint CellStream::on_screen(const glm::dvec3& p) const {
    const glm::dvec2 place = transform_.to_screen(p), snapped = glm::round(place * snaps_per_pixel) / snaps_per_pixel;
    return {snapped, glm::vec2(snapped - place), transform_.perspective() ? 1.0 / p.z : p.z};
}

void CellStream::set_corner(Corners& corners, std::size_t i, const ScreenPoint& point, double scalar) const {
    corners.vertices[i] = {point.position, point.depth, transform_.perspective() ? scalar * point.depth : scalar};
    corners.moved[i] = point.moved;
}

// False when a corner lies behind the near plane.
bool CellStream::load(CellId cell, Corners& corners) const {
    const auto& tet = prepared_.scene().mesh->tets[cell];
    const bool per_point = prepared_.scene().field->location == FieldLocation::points;
    for (std::size_t i = 0; i < 4; ++i) {
        const ScreenPoint& p = points_[tet[i]];
        const double scalar = scalars_[per_point ? tet[i] : cell];
        if (transform_.perspective() && p.depth == 0.0) return false;
        set_corner(corners, i, p, scalar);
    }
    return true;
}

std::array<EyeVertex, 4> CellStream::eye_corners(CellId cell) const {
    const TetMesh& mesh = *prepared_.scene().mesh;
    const bool per_point = prepared_.scene().field->location == FieldLocation::points;
    std::array<EyeVertex, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
        const VertexId v = mesh.tets[cell][i];
        corners[i] = {transform_.to_eye((mesh.points[v] - eye_) / prepared_.units().length), scalars_[per_point ? v : cell]};
    }
    return corners;
}

// Position and scalar are linear in space: both are mixed by the same weights.
std::array<EyeVertex, 4> CellStream::eye_corners(const CellPiece& piece) const {
    const std::array<EyeVertex, 4> cell = eye_corners(piece.cell);
    std::array<EyeVertex, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
        corners[i] = {glm::dvec3(0.0), 0.0};
        for (int v = 0; v < 4; ++v) {
            const EyeVertex& vertex = cell[static_cast<std::size_t>(v)];
            corners[i].position += piece.corners[i][v] * vertex.position;
            corners[i].scalar += piece.corners[i][v] * vertex.scalar;
        }
    }
    return corners;
}

// The part in front of the near plane, on the screen.
CellStream::Pieces CellStream::clipped(const std::array<EyeVertex, 4>& corners) const {
    if (!transform_.perspective()) {
        Pieces whole{1, {}};
        for (std::size_t i = 0; i < 4; ++i) set_corner(whole.corners[0], i, on_screen(corners[i].position), corners[i].scalar);
        return whole;
    }
    const ClippedTet tets = clip_near(corners, near_depth_);
    Pieces pieces{tets.count, {}};
    for (std::size_t piece = 0; piece < tets.count; ++piece) {
        for (std::size_t i = 0; i < 4; ++i) {
            const EyeVertex& v = tets.tets[piece][i];
            set_corner(pieces.corners[piece], i, on_screen(v.position), v.scalar);
        }
    }
    return pieces;
}

bool CellStream::project_corners(const Corners& corners, TriangleBatch& batch) const {
    const Rectangle box = bounding_box(corners.vertices);
    if (!covers_pixel(box)) return false;
    const Silhouette silhouette =
        make_silhouette(corners.vertices, corners.moved, origin_for(box), transform_.perspective());
    if (silhouette.triangle_count == 0) return false;

    const StreamVertex constants = cell_constants(corners.vertices, silhouette);
    const bool cut = !inside(guard_, box);
    if (!cut && silhouette.triangle_count == 2) {
        // What belongs to a triangle is read at its last vertex: four serve both.
        const auto first = static_cast<std::uint32_t>(batch.vertices.size());
        batch.vertices.resize(first + 4);
        for (std::size_t t = 0; t < 2; ++t) {
            const StreamVertex terms = triangle_terms(silhouette, t, constants);
            for (const std::uint8_t corner : silhouette.triangles[t]) {
                batch.vertices[first + corner] = stream_vertex(silhouette.vertices[corner], terms);
                batch.indices.push_back(first + corner);
            }
        }
        return true;
    }
    for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
        const StreamVertex terms = triangle_terms(silhouette, t, constants);
        const auto& [a, b, c] = silhouette.triangles[t];
        const std::array vertices{silhouette.vertices[a], silhouette.vertices[b], silhouette.vertices[c]};
        constexpr std::array<std::array<std::uint8_t, 3>, 1> triangle{{{0, 1, 2}}};
        append(std::span<const SilhouetteVertex>(vertices), std::span(triangle), cut, guard_, batch,
               [&](const SilhouetteVertex& v) { return stream_vertex(v, terms); });
    }
    return true;
}

bool CellStream::light_corners(const Corners& corners, const VertexLighting& lighting, LitBatch& batch) const {
    const Rectangle box = bounding_box(corners.vertices);
    if (!covers_pixel(box)) return false;
    const ProjectedTet tet = project_tet(corners.vertices, transform_.perspective());
    const auto thick = static_cast<std::size_t>(tet.thick);
    if (tet.kind == ProjectionClass::nothing || tet.vertices[thick].thickness == 0.0) return false;

    const VertexLight light = light_at(tet.vertices[thick], lighting);
    std::array<LitCorner, 5> lit;
    LitVertex constants{};
    constants.weight = static_cast<float>(light.weight);
    constants.opacity = static_cast<float>(light.opacity);
    for (std::size_t v = 0; v < tet.vertex_count(); ++v) {
        const ProjectedVertex& vertex = tet.vertices[v];
        const double scalar = transform_.perspective() ? vertex.front_scalar / vertex.front_depth : vertex.front_scalar;
        const glm::dvec3 color = v == thick ? light.color : lighting.color_at_silhouette(scalar, light);
        lit[v] = {vertex.position, v == thick ? 1.0 : 0.0, glm::min(color, brightest_color)};
        for (int channel = 0; channel < 3; ++channel) {
            constants.brightest = std::max(constants.brightest, static_cast<float>(lit[v].color[channel]));
        }
    }
    append(std::span<const LitCorner>(lit).first(tet.vertex_count()),
           std::span(tet.triangles).first(tet.triangle_count()), !inside(guard_, box), guard_, batch,
           [&](const LitCorner& corner) {
               const glm::vec2 position = clip_space(corner.position);
               LitVertex v = constants;
               v.x = position.x;
               v.y = position.y;
               v.share = static_cast<float>(corner.share);
               for (int channel = 0; channel < 3; ++channel) v.color[channel] = static_cast<float>(corner.color[channel]);
               return v;
           });
    return true;
}

// The light of the segment at the thick vertex: what shaders/cell.frag computes for each pixel.
VertexLight CellStream::light_at(const ProjectedVertex& thick, const VertexLighting& lighting) const {
    if (!transform_.perspective()) return lighting.at_thick_vertex(thick.front_scalar, thick.back_scalar, thick.thickness);
    const double front = thick.front_depth;
    // Rounding must not carry the far end of a cell that reaches very far to infinity or beyond.
    const double back = std::max(front - thick.thickness, 1e-15 * front);
    const bool at_near_plane = front * near_depth_ > 0.999;
    const double depth_difference = at_near_plane ? 1.0 / back : thick.thickness / (front * back);
    const glm::dvec2 offset = (thick.position - transform_.principal_point()) / transform_.pixels_per_unit();
    return lighting.at_thick_vertex(thick.front_scalar / front, thick.back_scalar / back,
                                    depth_difference * glm::length(glm::dvec3(offset, 1.0)));
}

// Whether the box holds a pixel centre of the picture.
bool CellStream::covers_pixel(const Rectangle& box) const {
    const glm::dvec2 picture(transform_.size().width, transform_.size().height);
    const glm::dvec2 first = glm::max(glm::ceil(box.low - 0.5), glm::dvec2(0.0));
    const glm::dvec2 last = glm::min(glm::floor(box.high - 0.5), picture - 1.0);
    return first.x <= last.x && first.y <= last.y;
}

glm::vec2 CellStream::clip_space(const glm::dvec2& position) const {
    const ImageSize size = transform_.size();
    return {2 * position.x / size.width - 1, 2 * position.y / size.height - 1};
}

// The part of a vertex that is equal for a whole cell.
StreamVertex CellStream::cell_constants(const std::array<ScreenVertex, 4>& corners, const Silhouette& silhouette) const {
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
    // The slope of a nearly flat cell must stay finite: infinity times no thickness is not a number.
    constants.scalar_slope = static_cast<float>(std::clamp(silhouette.scalar_slope, -1e30, 1e30));
    constants.scalar_low = static_cast<float>(low);
    constants.scalar_high = static_cast<float>(high);
    constants.depth_range = static_cast<float>(silhouette.base_is_front ? far - near : near - far);
    return constants;
}

// The pixel of the picture nearest to the middle of the box.
glm::dvec2 CellStream::origin_for(const Rectangle& box) const {
    const glm::dvec2 picture(transform_.size().width, transform_.size().height);
    return glm::clamp(glm::floor(0.5 * (box.low + box.high)), glm::dvec2(0.0), picture - 1.0) + 0.5;
}

StreamVertex CellStream::triangle_terms(const Silhouette& silhouette, std::size_t triangle, const StreamVertex& constants) const {
    const auto set = [](float* floats, const ScreenPlane& plane) {
        floats[0] = static_cast<float>(plane.value);
        floats[1] = static_cast<float>(plane.gradient.x);
        floats[2] = static_cast<float>(plane.gradient.y);
    };
    const SilhouetteTerms& terms = silhouette.terms[triangle];
    StreamVertex out = constants;
    set(out.base_depth, terms.base_depth);
    set(out.base_scalar, terms.base_scalar);
    for (std::size_t ridge = 0; ridge < 3; ++ridge) set(out.thickness[ridge], terms.thickness[ridge]);
    out.origin_x = static_cast<float>(silhouette.origin.x);
    out.origin_y = static_cast<float>(silhouette.origin.y);
    return out;
}

StreamVertex CellStream::stream_vertex(const SilhouetteVertex& v, const StreamVertex& terms) const {
    const glm::vec2 position = clip_space(v.position);
    StreamVertex out = terms;
    out.x = position.x;
    out.y = position.y;
    for (int ridge = 0; ridge < 3; ++ridge) out.ridges[ridge] = static_cast<float>(v.ridges[ridge]);
    return out;
}

}  // namespace cellproj
