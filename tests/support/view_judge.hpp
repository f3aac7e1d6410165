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
        if (!(slack_ > 0)) return truths;
        const std::vector<std::size_t> doubtful = this->doubtful(image, enough);
        std::vector<PixelId> pixels;
        for (const std::size_t i : doubtful) pixels.push_back(centers_[i].pixel);
        const std::vector<PixelTruth> ranges = judge_.pixels(camera_, size_, pixels, slack_);
        for (std::size_t i = 0; i < doubtful.size(); ++i) truths[doubtful[i]] = ranges[i];
        return truths;
    }

    // The pixels off by `enough` or more at their centres, as indices into those that count.
    std::vector<std::size_t> doubtful(const Image& image, double enough) const {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < centers_.size(); ++i) {
            const glm::dvec4 error = error_of_pixel(image, centers_[i]);
            if (!(std::max({error.r, error.g, error.b, error.a}) < enough)) found.push_back(i);
        }
        return found;
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
    Judge judge_;
    Camera camera_;
    ImageSize size_;
    double slack_;
    std::vector<PixelTruth> centers_;
};

// The largest error of any channel of all pixels, exact from `tolerance` on. Only silhouettes may be off by more at the centres of pixels: a
// twentieth of them.
template <class Judge>
double error_but_for_silhouettes(const Image& image, Judge judge, const Camera& camera, double tolerance, double slack) {
    EXPECT_EQ(count_non_finite(image), 0U);
    const ImageSize size{image.width, image.height};
    const ViewJudge view(std::move(judge), camera, size, slack);
    EXPECT_LT(view.doubtful(image, tolerance).size(), all_pixels(size).size() / 20);
    return largest(view.compare(image, tolerance));
}

}  // namespace cellproj::testing_support
