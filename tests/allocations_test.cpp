// SPDX-License-Identifier: BSD-3-Clause
//
// What a renderer takes: for its first picture a bounded number of bytes per cell, from the second one on only the picture itself. Sanitizers bring an allocator of their
// own, so that this is looked at without them.
#include <gtest/gtest.h>

#include <malloc.h>

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

std::atomic<std::size_t> large_bytes = 0;           // that were asked for, so far
std::atomic<std::size_t> held_bytes = 0, most_held = 0;  // now; at one time

}  // namespace

#if !CELLPROJ_SANITIZED

namespace {

constexpr std::size_t large = 4096;  // what tasks need is smaller

void* counted(std::size_t size, std::size_t alignment) {
    if (size >= large) large_bytes += size;
    void* memory = alignment > alignof(std::max_align_t) ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                                                         : std::malloc(size > 0 ? size : 1);
    if (!memory) throw std::bad_alloc();
    const std::size_t usable = malloc_usable_size(memory), held = held_bytes += usable;
    for (std::size_t most = most_held; most < held && !most_held.compare_exchange_weak(most, held);) {}
    return memory;
}

void release(void* memory) {
    held_bytes -= malloc_usable_size(memory);  // of null: 0
    std::free(memory);
}

}  // namespace

#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // both are replaced
void* operator new(std::size_t size) { return counted(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) { return counted(size, static_cast<std::size_t>(alignment)); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

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

// The most at one time, which is while the sorter is made: twice the neighbours, 16 bytes each; points twice, 16 bytes each, here 7 a cell together;
// what is kept of scalars and visibility, 5; and on the way 8. Chunks of the order and what threads need: less than a megabyte.
TEST(Allocations, AFirstPictureTakesLessThanSixtyBytesACell) {
    if (CELLPROJ_SANITIZED) GTEST_SKIP() << "sanitizers allocate themselves";
    constexpr ImageSize size{160, 120};
    const Scene scene = scene_of(grid_mesh(40, 0.2), [](const glm::dvec3& p) { return p.x; }, testing_support::constant_medium(3));
    const auto renderer = make_renderer(Backend::cpu);
    const std::size_t before = most_held = held_bytes.load();
    renderer->render(scene, testing_support::view_of_unit_cube(Camera::Projection::perspective), size);
    EXPECT_LT(most_held - before, 60 * scene.mesh->tets.size() + 1'000'000);
}

}  // namespace
}  // namespace cellproj
