// SPDX-License-Identifier: BSD-3-Clause
//
// Bare voxels: every type and byte order, and sizes that do not fit.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace raw_volume_test {

template <class T>
std::string bytes_of_values(const std::vector<T>& values, bool big_endian) {
    std::string bytes;
    for (const T value : values) {
        std::string own(sizeof(T), '\0');
        std::memcpy(own.data(), &value, sizeof(T));
        if (big_endian != (std::endian::native == std::endian::big)) std::reverse(own.begin(), own.end());
        bytes += own;
    }
    return bytes;
}

// 2 x 2 x 3 numbers, the smallest and largest of the type among them.
template <class T>
void expect_type(NumberType type) {
    using Limits = std::numeric_limits<T>;
    std::vector<T> values{
        Limits::lowest(), Limits::max(), T{0}, T{1}, T{2}, T{3}, T{4}, T{5}, T{6}, T{7}, T{8}, T{100}};
    for (const bool big_endian : {false, true}) {
        RawVolume raw{.dimensions = {2, 2, 3}, .type = type, .big_endian = big_endian, .header_bytes = 5};
        const Dataset dataset = read(write("v.raw", "12345" + bytes_of_values(values, big_endian)), {.raw = raw});
        ASSERT_EQ(dataset.point_fields.size(), 1U);
        EXPECT_EQ(dataset.point_fields[0].name, "value");
        EXPECT_EQ(dataset.point_fields[0].values, std::vector<double>(values.begin(), values.end()));
    }
}

TEST(RawVolume, EveryTypeInBothByteOrders) {
    expect_type<std::int8_t>(NumberType::int8);
    expect_type<std::uint8_t>(NumberType::uint8);
    expect_type<std::int16_t>(NumberType::int16);
    expect_type<std::uint16_t>(NumberType::uint16);
    expect_type<std::int32_t>(NumberType::int32);
    expect_type<std::uint32_t>(NumberType::uint32);
    expect_type<float>(NumberType::float32);
    expect_type<double>(NumberType::float64);
}

TEST(RawVolume, PointsLieAtTheSpacingFromTheOriginXFastest) {
    const RawVolume raw{.dimensions = {4, 3, 2}, .spacing = {0.5, 1, 2}, .origin = {1, 2, -1}};
    // Content of another format does not matter: the user has said what it is.
    const Dataset dataset = read(write("voxels.vtu", "<VTKFile" + std::string(16, 'x')), {.raw = raw});
    EXPECT_EQ(dataset.format, "raw volume");
    ASSERT_TRUE(dataset.grid);
    EXPECT_EQ(dataset.grid->ni, 4U);
    EXPECT_EQ(dataset.grid->nk, 2U);
    EXPECT_EQ(dataset.points[1], glm::dvec3(1.5, 2, -1));
    EXPECT_EQ(dataset.points[4 * 3 + 2 * 4 + 3], glm::dvec3(2.5, 4, 1));
    EXPECT_EQ(dataset.point_fields[0].values[0], '<');
}

TEST(RawVolume, ASizeThatDoesNotFitTellsWhatWould) {
    const fs::path file = write("v.raw", std::string(64, 'v'));
    const auto expect = [&](const RawVolume& raw, const std::string& words) {
        expect_error(file, ErrorKind::format, words, {.raw = raw});
    };
    expect({.dimensions = {4, 4, 5}},
           "expected 80 bytes, 4 x 4 x 5 times 1, found a file of 64 bytes, which fits 4 x 4 x 4 of this type");
    expect({.dimensions = {4, 4, 2}}, "4 x 4 x 2 of a type of 2 bytes");
    expect({.dimensions = {4, 4, 2}}, "a header would take 32 bytes");
    expect({.dimensions = {3, 5, 2}, .type = NumberType::float64}, "2 x 2 x 2 of a type of 8 bytes");
    expect({.dimensions = {4, 4, 4}, .header_bytes = 1}, "behind a header of 1");
    expect({.dimensions = {4, 4, 4}, .header_bytes = std::numeric_limits<std::uint64_t>::max()}, "64 bytes");
    expect_error(file, ErrorKind::option, "at least 2 points", {.raw = RawVolume{.dimensions = {64, 1, 1}}});
    expect_error(file, ErrorKind::option, "at most",
                 {.raw = RawVolume{.dimensions = {1U << 31U, 1U << 31U, 1U << 31U}}});
    expect_error(file, ErrorKind::option, "spacing", {.raw = RawVolume{.dimensions = {4, 4, 4}, .spacing = {1, 0, 1}}});
    expect_error(file, ErrorKind::option, "origin",
                 {.raw = RawVolume{.dimensions = {4, 4, 4}, .origin = {0, 0, std::nan("")}}});
    expect_error(file, ErrorKind::option, "without block names",
                 {.blocks = {"a"}, .raw = RawVolume{.dimensions = {4, 4, 4}}});
    expect_error(file, ErrorKind::format, "--dims NX NY NZ --type");
}

}  // namespace
}  // namespace cellproj
