// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures of one view against the judge, at a fifth of the rays that a slack for rasterizers takes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "project/camera.hpp"
#include "render/image.hpp"
#include "render/judge/pixel_truths.hpp"
#include "render/judge/reference.hpp"

namespace cellproj::testing_support {

// A pixel is right within a bound if it is as near to what the judge sees at some place within `slack` of its centre (PixelTruth). One that
// is as near to the centre's own light is right whatever the others are, so only for what is left the judge looks around. `Judge`:
// has pixels(camera, size, pixels, slack).
template <class Judge>
class ViewJudge {
public:
    // `pixels`: those that count.
    ViewJudge(Judge judge, const Camera& camera, ImageSize size, double slack, const std::vector<PixelId>& pixels)
        : judge_(std::move(judge)), camera_(camera), size_(size), slack_(slack), centers_(judge_.pixels(camera, size, pixels)) {}
    ViewJudge(Judge judge, const Camera& camera, ImageSize size, double slack = 0)
        : ViewJudge(std::move(judge), camera, size, slack, all_pixels(size)) {}

    // What the picture's pixels should be: those off by `enough` or more with the slack, the others at their centres.
    std::vector<PixelTruth> truths_for(const Image& image, double enough) const {
        std::vector<PixelTruth> truths = centers_;
        if (slack_ > 0) look_around(truths, image, enough);
        return truths;
    }

    // The errors of the picture, exact from `enough` on.
    ImageError compare(const Image& image, double enough) const { return cellproj::compare(image, truths_for(image, enough)); }

    // For EXPECT_TRUE: whether every channel of every pixel is within the bound.
    testing::AssertionResult within(const Image& image, double bound) const {
        const double error = largest(compare(image, bound));
        if (error < bound) return testing::AssertionSuccess();
        return testing::AssertionFailure() << "off by up to " << error << ", not less than " << bound;
    }

private:
    void look_around(std::vector<PixelTruth>& truths, const Image& image, double enough) const {
        std::vector<std::size_t> doubtful;
        std::vector<PixelId> pixels;
        for (std::size_t i = 0; i < truths.size(); ++i) {
            const glm::dvec4 error = error_of_pixel(image, truths[i]);
            if (std::max({error.r, error.g, error.b, error.a}) < enough) continue;  // what is not finite is infinitely wrong
            doubtful.push_back(i);
            pixels.push_back(truths[i].pixel);
        }
        const std::vector<PixelTruth> ranges = judge_.pixels(camera_, size_, pixels, slack_);
        for (std::size_t i = 0; i < doubtful.size(); ++i) truths[doubtful[i]] = ranges[i];
    }

    Judge judge_;
    Camera camera_;
    ImageSize size_;
    double slack_;
    std::vector<PixelTruth> centers_;
};

}  // namespace cellproj::testing_support
