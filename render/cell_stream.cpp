// SPDX-License-Identifier: BSD-3-Clause
#include "render/cell_stream.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "render/scene_view.hpp"

namespace cellproj {

namespace {

// Rasterizers snap vertices to a grid of 1/256 of a pixel (llvmpipe, and most GPUs). Doing it before anything is decided makes
// that harmless: cells are those of a mesh whose points have moved by less than 1/512 of a pixel, the same for all cells at a
// point, and no pixel centre falls between what the projection and what the rasterizer takes a cell to cover. Scalars stay
// where they were (project/silhouette.hpp).
constexpr double snaps_per_pixel = 256.0;

// How far beyond the picture triangles may reach, in pictures. Within it, float32 positions are good to 1e-6 of the picture.
constexpr double guard_pictures = 1.0;

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

void set_plane(float* floats, const ScreenPlane& plane) {
    floats[0] = static_cast<float>(plane.value);
    floats[1] = static_cast<float>(plane.gradient.x);
    floats[2] = static_cast<float>(plane.gradient.y);
}

void set_triangle_terms(const Silhouette& silhouette, std::size_t triangle, const NearnessFrame& frame, StreamVertex& vertex) {
    const SilhouetteTerms& terms = silhouette.terms[triangle];
    set_plane(vertex.base_depth, {terms.base_depth.value - frame.far, terms.base_depth.gradient});
    set_plane(vertex.base_scalar, terms.base_scalar);
    for (std::size_t ridge = 0; ridge < 3; ++ridge) set_plane(vertex.thickness[ridge], terms.thickness[ridge]);
    vertex.origin_x = static_cast<float>(silhouette.origin.x);
    vertex.origin_y = static_cast<float>(silhouette.origin.y);
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
    : prepared_(prepared), eye_(camera.eye),
      transform_(relative_transform(camera, size, prepared.units().length)),
      near_depth_(near_plane_depth(camera, prepared.units().length)) {
    const glm::dvec2 picture(size.width, size.height);
    guard_ = {-guard_pictures * picture, (1 + guard_pictures) * picture};

    const TetMesh& mesh = *prepared.scene().mesh;
    const ScalarField& field = *prepared.scene().field;
    const ScalarField* opacity = prepared.scene().opacity_field.get();
    const SceneUnits& units = prepared.units();
    points_.resize(mesh.points.size());
    scalars_.resize(field.values.size());
    opacity_scalars_.resize(opacity ? opacity->values.size() : 0);
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
    oneapi::tbb::parallel_for(Range(0, opacity_scalars_.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            opacity_scalars_[i] = units.normalized_opacity(opacity->values[i]);
    });
}

// Calls draw(cell, corners) for every cell to draw or, where it is split or cut by the near plane, for its pieces; it says
// whether anything was drawn.
template <class Vertex, class Draw>
void CellStream::for_each_piece(const ViewOrder& order, Triangles<Vertex>& batch, Draw draw) const {
    const std::vector<std::uint8_t>& visible = prepared_.visible();
    const auto cells = static_cast<std::uint32_t>(visible.size());
    const auto draw_clipped = [&](CellId cell, const EyeCorners& corners) {
        const Pieces pieces = clipped(corners);
        bool drawn = false;
        for (std::size_t piece = 0; piece < pieces.count; ++piece) drawn |= draw(cell, pieces.corners[piece]);
        return drawn;
    };
    for (const std::uint32_t item : order.items) {
        if (item >= cells) {
            const CellPiece& piece = order.pieces[item - cells];
            if (visible[piece.cell] && draw_clipped(piece.cell, eye_corners(piece))) batch.drawn_split_cells.push_back(piece.cell);
            continue;
        }
        if (!visible[item]) continue;
        Corners corners;
        if (load(item, corners) ? draw(item, corners) : draw_clipped(item, eye_corners(item))) ++batch.drawn_cells;
    }
}

void CellStream::project(const ViewOrder& order, TriangleBatch& batch) const {
    for_each_piece(order, batch, [&](CellId, const Corners& corners) { return project_corners(corners, batch); });
}

void CellStream::project(const ViewOrder& order, TwoFieldBatch& batch) const {
    for_each_piece(order, batch, [&](CellId, const Corners& corners) { return project_corners(corners, batch); });
}

void CellStream::project(const ViewOrder& order, const VertexLighting& lighting, LitBatch& batch) const {
    for_each_piece(order, batch, [&](CellId, const Corners& corners) { return light_corners(corners, lighting, batch); });
}

void CellStream::project(const ViewOrder& order, const NearnessFrame& frame, SurfaceBatch& batch) const {
    for_each_piece(order, batch, [&](CellId cell, const Corners& corners) { return project_surfaces(cell, corners, frame, batch); });
}

NearnessFrame CellStream::nearness_frame() const {
    double far = 0.0, near = 0.0;
    bool first = true;
    for (const ScreenPoint& p : points_) {
        if (transform_.perspective() && p.depth == 0.0) continue;
        const bool farther = transform_.perspective() == (p.depth < far);
        if (first || farther) far = p.depth;
        if (first || transform_.perspective() == (p.depth > near)) near = p.depth;
        first = false;
    }
    if (transform_.perspective()) {
        const double plane = 1.0 / near_depth_;  // where cells are cut
        if (first) far = plane;
        return {true, far, std::max(plane - far, 1e-30)};
    }
    return {false, far, std::max(far - near, 1e-30)};
}

NearnessFrame CellStream::segment_frame() const {
    return {transform_.perspective(), transform_.perspective() ? 0.0 : points_.front().depth, 1.0};
}

CellStream::ScreenPoint CellStream::on_screen(const glm::dvec3& p) const {
    const glm::dvec2 place = transform_.to_screen(p), snapped = glm::round(place * snaps_per_pixel) / snaps_per_pixel;
    return {snapped, glm::vec2(snapped - place), transform_.perspective() ? 1.0 / p.z : p.z};
}

void CellStream::set_corner(Corners& corners, std::size_t i, const ScreenPoint& point, double scalar, double opacity_scalar) const {
    const double factor = transform_.perspective() ? point.depth : 1.0;
    corners.vertices[i] = {point.position, point.depth, scalar * factor};
    corners.moved[i] = point.moved;
    corners.opacity_scalars[i] = opacity_scalar * factor;
}

std::array<ScreenVertex, 4> CellStream::Corners::with_opacity_scalars() const {
    std::array<ScreenVertex, 4> result = vertices;
    for (std::size_t i = 0; i < 4; ++i) result[i].scalar = opacity_scalars[i];
    return result;
}

double CellStream::opacity_scalar(CellId cell, VertexId vertex) const {
    if (opacity_scalars_.empty()) return 0.0;
    return opacity_scalars_[prepared_.scene().opacity_field->location == FieldLocation::points ? vertex : cell];
}

// False when a corner lies behind the near plane.
bool CellStream::load(CellId cell, Corners& corners) const {
    const auto& tet = prepared_.scene().mesh->tets[cell];
    const bool per_point = prepared_.scene().field->location == FieldLocation::points;
    for (std::size_t i = 0; i < 4; ++i) {
        const ScreenPoint& p = points_[tet[i]];
        const double scalar = scalars_[per_point ? tet[i] : cell];
        if (transform_.perspective() && p.depth == 0.0) return false;
        set_corner(corners, i, p, scalar, opacity_scalar(cell, tet[i]));
    }
    corners.whole = true;
    return true;
}

CellStream::EyeCorners CellStream::eye_corners(CellId cell) const {
    const TetMesh& mesh = *prepared_.scene().mesh;
    const bool per_point = prepared_.scene().field->location == FieldLocation::points;
    EyeCorners corners;
    for (std::size_t i = 0; i < 4; ++i) {
        const VertexId v = mesh.tets[cell][i];
        const glm::dvec3 p = transform_.to_eye((mesh.points[v] - eye_) / prepared_.units().length);
        corners.vertices[i] = {p, scalars_[per_point ? v : cell]};
        corners.opacity_scalars[i] = opacity_scalar(cell, v);
    }
    return corners;
}

// Position and scalars are linear in space: all are mixed by the same weights.
CellStream::EyeCorners CellStream::eye_corners(const CellPiece& piece) const {
    const EyeCorners cell = eye_corners(piece.cell);
    EyeCorners corners;
    for (std::size_t i = 0; i < 4; ++i) {
        corners.vertices[i] = {glm::dvec3(0.0), 0.0};
        corners.opacity_scalars[i] = 0.0;
        for (int v = 0; v < 4; ++v) {
            const auto corner = static_cast<std::size_t>(v);
            corners.vertices[i].position += piece.corners[i][v] * cell.vertices[corner].position;
            corners.vertices[i].scalar += piece.corners[i][v] * cell.vertices[corner].scalar;
            corners.opacity_scalars[i] += piece.corners[i][v] * cell.opacity_scalars[corner];
        }
    }
    return corners;
}

// The part in front of the near plane, on the screen.
CellStream::Pieces CellStream::clipped(const EyeCorners& corners) const {
    if (!transform_.perspective()) {
        Pieces whole{1, {}};
        for (std::size_t i = 0; i < 4; ++i) {
            const EyeVertex& v = corners.vertices[i];
            set_corner(whole.corners[0], i, on_screen(v.position), v.scalar, corners.opacity_scalars[i]);
        }
        return whole;
    }
    const ClippedTet tets = clip_near(corners.vertices, near_depth_);
    // Clipping follows positions alone: once more gives the same corners with the other scalar.
    ClippedTet opacity = tets;
    if (!opacity_scalars_.empty()) {
        EyeCorners other = corners;
        for (std::size_t i = 0; i < 4; ++i) other.vertices[i].scalar = corners.opacity_scalars[i];
        opacity = clip_near(other.vertices, near_depth_);
    }
    Pieces pieces{tets.count, {}};
    for (std::size_t piece = 0; piece < tets.count; ++piece) {
        for (std::size_t i = 0; i < 4; ++i) {
            const EyeVertex& v = tets.tets[piece][i];
            set_corner(pieces.corners[piece], i, on_screen(v.position), v.scalar, opacity.tets[piece][i].scalar);
        }
    }
    return pieces;
}

// Of a cell, a triangle of it and a corner there, one after the other: all but what the ones after it set.
template <class Vertex>
class CellStream::VertexMaker {
public:
    VertexMaker(const CellStream& stream, const Corners& corners, const glm::dvec2& origin)
        : stream_(stream),
          silhouette_(make_silhouette(corners.vertices, corners.moved, origin, stream.transform_.perspective())) {
        if (silhouette_.triangle_count == 0) return;
        stream.set_cell_constants(corners.vertices, silhouette_, vertex_);
        if constexpr (has_opacity) set_opacity_constants(corners);
    }

    const Silhouette& silhouette() const { return silhouette_; }

    void begin_triangle(std::size_t triangle) {
        set_triangle_terms(silhouette_, triangle, stream_.segment_frame(), vertex_);
        if constexpr (has_opacity) set_plane(vertex_.base_opacity, opacity_silhouette_.terms[triangle].base_scalar);
    }

    Vertex at(const SilhouetteVertex& v) {
        stream_.set_place(v, vertex_);
        return vertex_;
    }

private:
    static constexpr bool has_opacity = std::is_same_v<Vertex, TwoFieldVertex>;

    // The silhouette of the same cell with the other scalar differs in nothing else.
    void set_opacity_constants(const Corners& corners) {
        const auto with_opacity = corners.with_opacity_scalars();
        opacity_silhouette_ =
            make_silhouette(with_opacity, corners.moved, silhouette_.origin, stream_.transform_.perspective());
        StreamVertex constants{};
        stream_.set_cell_constants(with_opacity, opacity_silhouette_, constants);
        vertex_.opacity_slope = constants.scalar_slope;
        vertex_.opacity_low = constants.scalar_low;
        vertex_.opacity_high = constants.scalar_high;
    }

    const CellStream& stream_;
    Silhouette silhouette_, opacity_silhouette_;
    Vertex vertex_{};
};

template <class Vertex>
bool CellStream::project_corners(const Corners& corners, Triangles<Vertex>& batch) const {
    const Rectangle box = bounding_box(corners.vertices);
    if (!covers_pixel(box)) return false;
    VertexMaker<Vertex> make(*this, corners, origin_for(box));
    return append_silhouette(make, box, batch);
}

template <class Maker, class Vertex>
bool CellStream::append_silhouette(Maker& make, const Rectangle& box, Triangles<Vertex>& batch) const {
    const Silhouette& silhouette = make.silhouette();
    if (silhouette.triangle_count == 0) return false;

    const bool cut = !inside(guard_, box);
    if (!cut && silhouette.triangle_count == 2) {
        // What belongs to a triangle is read at its last vertex: four serve both.
        const auto first = static_cast<std::uint32_t>(batch.vertices.size());
        batch.vertices.resize(first + 4);
        for (std::size_t t = 0; t < 2; ++t) {
            make.begin_triangle(t);
            for (const std::uint8_t corner : silhouette.triangles[t]) {
                batch.vertices[first + corner] = make.at(silhouette.vertices[corner]);
                batch.indices.push_back(first + corner);
            }
        }
        return true;
    }
    for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
        make.begin_triangle(t);
        const auto& [a, b, c] = silhouette.triangles[t];
        const std::array vertices{silhouette.vertices[a], silhouette.vertices[b], silhouette.vertices[c]};
        constexpr std::array<std::array<std::uint8_t, 3>, 1> triangle{{{0, 1, 2}}};
        append(std::span<const SilhouetteVertex>(vertices), std::span(triangle), cut, guard_, batch,
               [&](const SilhouetteVertex& v) { return make.at(v); });
    }
    return true;
}

// As VertexMaker, for the vertices of isosurfaces.
class CellStream::SurfaceMaker {
public:
    SurfaceMaker(const CellStream& stream, CellId cell, const Corners& corners, const NearnessFrame& frame)
        : stream_(stream), outline_(make_outline(corners.vertices, stream.transform_.perspective())) {
        if (outline_.triangle_count == 0) return;
        std::array<double, 4> scalars;
        for (std::size_t c = 0; c < 4; ++c) {
            std::array<FaceCorner, 3> face;
            for (std::size_t i = 0; i < 3; ++i) {
                const ScreenVertex& v = corners.vertices[static_cast<std::size_t>(face_corners[c][i])];
                face[i] = {v.position, frame.nearness(v.depth), v.scalar};
            }
            faces_[c] = make_surface_face(face, stream.transform_.size());
            const ScreenVertex& v = corners.vertices[c];
            scalars[c] = frame.perspective ? v.scalar / v.depth : v.scalar;
            scalars_[c] = static_cast<float>(scalars[c]);
        }
        const CellSpan span = stream.span_of(corners.vertices);
        const PreparedSurfaces& surfaces = *stream.prepared_.surfaces();
        const std::int32_t first = level_of(surfaces.thresholds(), std::ranges::min(scalars_));
        const std::int32_t last = level_of(surfaces.thresholds(), std::ranges::max(scalars_));
        vertex_.first = static_cast<float>(first);
        vertex_.last = static_cast<float>(last);
        vertex_.depth_range = static_cast<float>(outline_.base_is_front ? span.far - span.near : span.near - span.far);
        const auto places_before = places_of(corners, 1.0, frame);
        if (!stream.opacity_scalars_.empty()) set_opacity(places_before, corners, frame);
        const AffineMap<double> scalar = make_scalar_map(places_before, scalars);
        vertex_.maps[0].scalar = static_cast<float>(scalar.value);
        for (std::size_t slope = 0; slope < 3; ++slope) vertex_.maps[slope + 1].scalar = static_cast<float>(scalar.slopes[slope]);
        if (first == last && !stream.prepared_.lights_medium()) return;
        std::array<glm::dvec3, 4> corner_gradients = gradients(surfaces, cell);
        if (!corners.whole) {
            // Of a piece, the cell's corners may lie where nothing is on the screen: those of the piece have their share of its gradients.
            const AffineMap<glm::dvec3> in_cell = make_gradient_map(places_of(cell, frame), corner_gradients);
            const double factor = largest_part(corner_gradients);
            for (std::size_t c = 0; c < 4; ++c) corner_gradients[c] = factor * in_cell.at(places_before[c]);
        }
        const AffineMap<glm::dvec3> gradient = make_gradient_map(places_of(corners, 0.0, frame), corner_gradients);
        // Surfaces ask for directions alone, a medium that is lit for lengths, too.
        const double size = stream.prepared_.lights_medium() ? largest_part(corner_gradients) : 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            vertex_.maps[0].gradient[axis] = static_cast<float>(size * gradient.value[axis]);
            for (std::size_t slope = 0; slope < 3; ++slope)
                vertex_.maps[slope + 1].gradient[axis] = static_cast<float>(size * gradient.slopes[slope][axis]);
        }
    }

    const Silhouette& silhouette() const { return outline_; }

    void begin_triangle(std::size_t triangle) {
        const std::size_t base = base_corner(outline_.triangles[triangle]);
        std::array<bool, 4> told{};
        std::size_t count = 0;
        const auto tell = [&](std::size_t corner) {
            if (told[corner]) return;
            told[corner] = true;
            vertex_.faces[count] = faces_[corner];
            vertex_.scalars[count++] = scalars_[corner];
        };
        tell(base);
        for (std::size_t ridge = 0; ridge < outline_.ridge_count; ++ridge) tell(outline_.ridge_corners[ridge]);
        for (std::size_t corner = 0; corner < 4; ++corner) tell(corner);  // through which no ray goes
    }

    SurfaceVertex at(const SilhouetteVertex& v) {
        stream_.set_place(v, vertex_);
        return vertex_;
    }

private:
    // In eye space, from the frame's farthest point on. `back` 0: where the rasterizer has the corners, for what is mixed by weights
    // (in a sliver, a place beside it has other ones); 1: where they were, for what is to stay there. Those of a piece serve for what is
    // linear in its cell.
    std::array<glm::dvec3, 4> places_of(const Corners& corners, double back, const NearnessFrame& frame) const {
        const ScreenTransform& transform = stream_.transform_;
        std::array<glm::dvec3, 4> places;
        for (std::size_t i = 0; i < 4; ++i) {
            const ScreenVertex& v = corners.vertices[i];
            const double depth = frame.perspective ? 1.0 / v.depth : v.depth;
            const glm::dvec2 across = (v.position - back * corners.moved[i] - transform.principal_point()) / transform.pixels_per_unit();
            places[i] = {across * (frame.perspective ? depth : 1.0), depth - frame.far_depth()};
        }
        return places;
    }
    std::array<glm::dvec3, 4> places_of(CellId cell, const NearnessFrame& frame) const {
        const EyeCorners corners = stream_.eye_corners(cell);
        std::array<glm::dvec3, 4> places;
        for (std::size_t i = 0; i < 4; ++i) places[i] = corners.vertices[i].position - glm::dvec3(0.0, 0.0, frame.far_depth());
        return places;
    }

    static double largest_part(const std::array<glm::dvec3, 4>& vectors) {
        double largest = 0.0;
        for (const glm::dvec3& v : vectors) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        return largest;
    }

    // At the cell's corners: its own four times (flat), those of its points (smooth), 0 (unlit).
    std::array<glm::dvec3, 4> gradients(const PreparedSurfaces& surfaces, CellId cell) const {
        std::array<glm::dvec3, 4> result{};
        const Shading shading = surfaces.scene().shading;
        const auto& corners = stream_.prepared_.scene().mesh->tets[cell];
        for (std::size_t corner = 0; corner < 4 && shading != Shading::unlit; ++corner)
            result[corner] = surfaces.gradients()[shading == Shading::flat ? cell : corners[corner]];
        return result;
    }

    void set_opacity(const std::array<glm::dvec3, 4>& places, const Corners& corners, const NearnessFrame& frame) {
        std::array<double, 4> scalars;
        for (std::size_t c = 0; c < 4; ++c)
            scalars[c] = frame.perspective ? corners.opacity_scalars[c] / corners.vertices[c].depth : corners.opacity_scalars[c];
        const AffineMap<double> map = make_scalar_map(places, scalars);
        vertex_.opacity_value = static_cast<float>(map.value);
        vertex_.opacity_slope_x = static_cast<float>(map.slopes[0]);
        vertex_.opacity_slope_y = static_cast<float>(map.slopes[1]);
        vertex_.opacity_slope_z = static_cast<float>(map.slopes[2]);
    }

    const CellStream& stream_;
    Silhouette outline_;
    std::array<SurfaceFace, 4> faces_;  // opposite to each corner
    std::array<float, 4> scalars_{};
    SurfaceVertex vertex_{};
};

bool CellStream::project_surfaces(CellId cell, const Corners& corners, const NearnessFrame& frame, SurfaceBatch& batch) const {
    const Rectangle box = bounding_box(corners.vertices);
    if (!covers_pixel(box)) return false;
    SurfaceMaker make(*this, cell, corners, frame);
    return append_silhouette(make, box, batch);
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

CellStream::CellSpan CellStream::span_of(const std::array<ScreenVertex, 4>& corners) const {
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
    return {near, far, low, high};
}

// The part of a vertex that is equal for a whole cell.
void CellStream::set_cell_constants(const std::array<ScreenVertex, 4>& corners, const Silhouette& silhouette,
                                    StreamVertex& constants) const {
    const auto [near, far, low, high] = span_of(corners);
    // The slope of a nearly flat cell must stay finite: infinity times no thickness is not a number.
    constants.scalar_slope = static_cast<float>(std::clamp(silhouette.scalar_slope, -1e30, 1e30));
    constants.scalar_low = static_cast<float>(low);
    constants.scalar_high = static_cast<float>(high);
    constants.depth_range = static_cast<float>(silhouette.base_is_front ? far - near : near - far);
}

// The pixel of the picture nearest to the middle of the box.
glm::dvec2 CellStream::origin_for(const Rectangle& box) const { return nearest_pixel(0.5 * (box.low + box.high), transform_.size()); }

template <class Vertex>
void CellStream::set_place(const SilhouetteVertex& v, Vertex& vertex) const {
    const glm::vec2 position = clip_space(v.position);
    vertex.x = position.x;
    vertex.y = position.y;
    for (int ridge = 0; ridge < 3; ++ridge) vertex.ridges[ridge] = static_cast<float>(v.ridges[ridge]);
}

}  // namespace cellproj
