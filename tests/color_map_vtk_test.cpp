// SPDX-License-Identifier: BSD-3-Clause
//
// ParaView's colour maps as VTK itself evaluates them: two implementations, one answer.
#include <gtest/gtest.h>
#include <vtkColorTransferFunction.h>
#include <vtkNew.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "classify/color_space.hpp"
#include "classify/transfer_function.hpp"

namespace cellproj {
namespace color_map_vtk_test {

struct ColorSpace {
    const char* name;
    int vtk;
    bool wrap;
    glm::dvec3 (*interpolate)(const glm::dvec3&, const glm::dvec3&, double);
};
constexpr std::array<ColorSpace, 4> curved{{{"HSV", VTK_CTF_HSV, false, interpolate_hsv},
                                            {"HSV", VTK_CTF_HSV, true, interpolate_hsv_wrapped},
                                            {"Lab", VTK_CTF_LAB, false, interpolate_lab},
                                            {"Diverging", VTK_CTF_DIVERGING, false, interpolate_diverging}}};

double largest_difference(const glm::dvec3& a, const glm::dvec3& b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

// Any two colours, dark and grey ones and such outside the screen's gamut on the way among them. 1e-11: the same formulas
// with the operations in another order; near grey a hue is a quotient of small differences.
TEST(ColorMapVtk, InterpolationsAgree) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (const ColorSpace& space : curved) {
        double worst = 0.0;
        for (int trial = 0; trial < 20000; ++trial) {
            const auto color = [&] { return glm::dvec3(share(random), share(random), share(random)); };
            const glm::dvec3 from = color(), to = color();
            const double t = share(random);
            vtkNew<vtkColorTransferFunction> vtk;
            vtk->SetColorSpace(space.vtk);
            vtk->SetHSVWrap(space.wrap);
            vtk->AddRGBPoint(0, from.r, from.g, from.b);
            vtk->AddRGBPoint(1, to.r, to.g, to.b);
            glm::dvec3 expected;
            vtk->GetColor(t, &expected.x);
            worst = std::max(worst, largest_difference(space.interpolate(from, to, t), expected));
        }
        EXPECT_LE(worst, 1e-11) << space.name << (space.wrap ? " wrapped" : "");
    }
}

// Whole maps of five nodes, linear and logarithmic: 1e-3 for the curve and, on a logarithmic axis, 1e-3 of the change from one
// of its bends to the next (at most 1). Not the diverging curve: VTK turns the hue of nearly grey ends, so that it misses its
// own nodes by up to .05, while ours goes to them.
TEST(ColorMapVtk, MapsAgree) {
    struct Space {
        const char* name;
        int vtk;
        double tolerance;
    };
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (const bool log : {false, true})
        for (const auto& [name, space, tolerance] : {Space{"RGB", VTK_CTF_RGB, 1e-12}, {"Step", VTK_CTF_STEP, 1e-12},
                                                     {"HSV", VTK_CTF_HSV, 1e-3}, {"Lab", VTK_CTF_LAB, 1e-3}}) {
            double worst = 0.0;
            for (int trial = 0; trial < 50; ++trial) {
                vtkNew<vtkColorTransferFunction> vtk;
                vtk->SetColorSpace(space);
                vtk->SetHSVWrap(false);
                if (log) vtk->SetScaleToLog10();
                std::string nodes;
                double first = 0.01 + share(random), last = first;
                for (int k = 0; k < 5; ++k) {
                    if (k > 0) last *= 1.0 + 5.0 * share(random);
                    const glm::dvec3 c(share(random), share(random), share(random));
                    vtk->AddRGBPoint(last, c.r, c.g, c.b);
                    std::array<char, 128> text{};
                    std::snprintf(text.data(), text.size(), "%s%.17g,%.17g,%.17g,%.17g", k > 0 ? "," : "", last, c.r, c.g, c.b);
                    nodes += text.data();
                }
                const TransferFunction ours =
                    parse_transfer_function(std::string(R"({"ColorSpace": ")") + name + R"(", "UseLogScale": )" + (log ? "1" : "0") +
                                                R"(, "RGBPoints": [)" + nodes + R"(], "Points": [1,0,0.5,0]})",
                                            "");
                for (int i = 0; i < 500; ++i) {
                    const double s = first + (last - first) * share(random);
                    // Two samples, the second at s: GetColor knows no logarithmic scale.
                    std::array<double, 6> colors{};
                    vtk->GetTable(first, s, 2, colors.data());
                    worst = std::max(worst, largest_difference(ours.color(s), {colors[3], colors[4], colors[5]}));
                }
            }
            EXPECT_LE(worst, tolerance + (log ? 1e-3 : 0.0)) << name << (log ? " log" : "");
        }
}

}  // namespace
}  // namespace cellproj
