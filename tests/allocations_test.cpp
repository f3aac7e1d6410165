// SPDX-License-Identifier: BSD-3-Clause
//
// A renderer keeps its memory: from the second picture of a scene on, only the picture itself is new. Sanitizers bring an allocator of their
// own, so that this is looked at without them.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace {

std::atomic<std::size_t> large_bytes = 0;

}  // namespace

#if !CELLPROJ_SANITIZED

namespace {

constexpr std::size_t large = 4096;  // what tasks need is smaller

void* counted(std::size_t size, std::size_t alignment) {
    if (size >= large) large_bytes += size;
    void* memory = alignment > alignof(std::max_align_t) ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                                                         : std::malloc(size > 0 ? size : 1);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // both are replaced
void* operator new(std::size_t size) { return counted(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) { return counted(size, static_cast<std::size_t>(alignment)); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

#endif

namespace cellproj {
namespace {

using testing_support::grid_mesh;
using testing_support::scene_of;

TEST(Allocations, ASecondPictureIsAllThatIsNew) {
    if (CELLPROJ_SANITIZED) GTEST_SKIP() << "sanitizers allocate themselves";
    constexpr ImageSize size{160, 120};
    const Scene scene = scene_of(grid_mesh(16, 0.2), [](const glm::dvec3& p) { return p.x; }, testing_support::constant_medium(3));
    for (const auto order : {OrderMethod::mpvo, OrderMethod::centroid}) {
        const auto renderer = make_renderer(Backend::cpu);
        const auto view = [](int i) {
            return testing_support::view_of_unit_cube(Camera::Projection::perspective, {std::cos(0.7 + i), std::sin(0.7 + i), 0.5});
        };
        Quality quality;
        quality.order = order;
        for (int i = 0; i < 3; ++i) renderer->render(scene, view(i), size, quality);
        const std::size_t before = large_bytes;
        for (int i = 3; i < 6; ++i) renderer->render(scene, view(i), size, quality);
        EXPECT_EQ(large_bytes - before, 3 * size.width * size.height * sizeof(glm::vec4)) << to_string(order);
    }
}

}  // namespace
}  // namespace cellproj
