// SPDX-License-Identifier: BSD-3-Clause
//
// What every backend needs of a scene and no view changes: its units, which cells can be seen at all, and the order's graph.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "project/camera.hpp"
#include "render/plan.hpp"
#include "render/prepared_surfaces.hpp"
#include "render/judge/ray_index.hpp"
#include "render/renderer.hpp"
#include "render/scene.hpp"
#include "render/statistics.hpp"
#include "sort/visibility_sorter.hpp"

namespace cellproj {

// Lengths and scalars inside a renderer are relative, so that float32 serves meshes and fields of any scale.
struct SceneUnits {
    double length;       // half the diagonal of the mesh's box [mesh units], > 0
    double scalar_low;   // the field's smallest finite value
    double scalar_high;  // the field's largest finite value
    double opacity_low = 0.0, opacity_high = 0.0;  // likewise of the opacity field, where there is one

    // 0 at scalar_low, 1 at scalar_high; 0 for a constant field.
    double normalized(double s) const { return normalized(s, scalar_low, scalar_high); }
    double normalized_opacity(double s) const { return normalized(s, opacity_low, opacity_high); }

private:
    static double normalized(double s, double low, double high) { return high > low ? (s - low) / (high - low) : 0.0; }
};

class PreparedScene {
public:
    // Throws Error (data) when the field does not fit the mesh or has no finite value.
    //
    // `sides`: of isosurfaces (PreparedSurfaces). Of the rules only `culling` counts here.
    explicit PreparedScene(Scene scene, const SurfaceSides& sides = {}, const PlanRules& rules = {});

    const Scene& scene() const { return scene_; }
    const SceneUnits& units() const { return units_; }
    // What a plan is made from.
    const SceneFacts& facts() const { return facts_; }
    // Made when it is asked for first: some scenes need no order.
    VisibilitySorter& sorter();
    // The order of the visible cells for a picture; valid until the next one. `method`: nothing for one that is exact for this mesh.
    ViewOrder order(const Camera& camera, ImageSize size, std::optional<OrderMethod> method, OrderReport* report);
    // What an order is worth, into the statistics: the report and, as the quality asks, violated relations and the judge on some pixels.
    void judge(const ViewOrder& order, const OrderReport& report, const Camera& camera, ImageSize size, const Quality& quality,
               Statistics& statistics);
    // Mean length of a segment over all cells and directions, 4·volume / surface by Cauchy's formula [SceneUnits::length],
    // > 0. Found when it is asked for first.
    double mean_chord();

    // visible()[cell] is 0 for cells that add nothing to any picture: no emission and no extinction over the range of
    // their scalars and no isosurface in them, or a scalar of either field that is not finite.
    // Without culling it is 1 for all but the last.
    const std::vector<std::uint8_t>& visible() const { return visible_; }
    // The visible cells as they lie in memory, for pictures that need no order. Valid until the scene changes.
    ViewOrder any_order();
    // Null for scenes that have none, and whose medium is not lit.
    const PreparedSurfaces* surfaces() const { return surfaces_ ? &*surfaces_ : nullptr; }
    // Whether anything but isosurfaces can be seen.
    bool has_medium() const { return facts_.medium > 0; }
    bool lights_medium() const { return facts_.lit_medium.has_value(); }

    // Another transfer function over the same mesh and field: only the visibility is found anew, for most cells from bins
    // of the field's range.
    void set_transfer(std::shared_ptr<const TransferFunction> transfer);
    // Other isosurfaces, or other shading or lights of them; null: none. Throws Error as `validate` does, and then nothing has changed.
    void set_surfaces(std::shared_ptr<const SurfaceScene> surfaces, const SurfaceSides& sides = {});

    // The bins of a cell's lowest and highest scalar; low > high where one is not finite.
    struct BinRange {
        std::uint16_t low = 1, high = 0;
    };

private:
    bool finite(std::size_t cell) const;  // all of its scalars
    void find_visible_cells();
    void find_facts();

    Scene scene_;
    SceneUnits units_;
    bool culling_;
    SceneFacts facts_;
    std::optional<VisibilitySorter> sorter_;
    std::optional<double> mean_chord_;  // once somebody has asked
    std::unique_ptr<const RayIndex> ray_index_;  // once an order was to be judged
    std::vector<BinRange> bins_, opacity_bins_;  // #T; none without an opacity field
    std::optional<PreparedSurfaces> surfaces_;
    std::vector<std::uint8_t> visible_;
    std::vector<CellId> any_order_;  // once somebody has asked
};

}  // namespace cellproj
