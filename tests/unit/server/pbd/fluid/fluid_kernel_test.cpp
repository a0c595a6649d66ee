// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/fluid/fluid_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace eti::pbd {
namespace {

constexpr double pi = std::numbers::pi;
constexpr float h = 2e-3f;

/// Midpoint rule over r from 0 to h, in doubles; 2000 strips leave 1e-6 of a smooth integrand.
template <class Integrand>
double radial(const Integrand& integrand) {
    constexpr int strips = 2000;
    double sum = 0.0;
    for (int k = 0; k < strips; ++k) {
        sum += integrand(h * (k + 0.5) / strips);
    }
    return sum * h / strips;
}

TEST(FluidKernel, IntegralIsOne) {
    const FluidKernel kernel(h);
    // 1e-5: a hundred float roundings.
    EXPECT_NEAR(radial([&](double r) { return 4.0 * pi * r * r * kernel.value(static_cast<float>(r)); }), 1.0,
                1e-5);
}

TEST(FluidKernel, GradientMatchesFiniteDifferences) {
    const FluidKernel kernel(h);
    const float step = 1e-3f * h;
    for (float q = 0.05f; q < 1.0f; q += 0.05f) {
        const float r = q * h;
        const float difference = (kernel.value(r + step) - kernel.value(r - step)) / (2.0f * step);
        // A float's rounding of the peak over two steps is 1e-7 / 2e-3 of peak / h. The scheme's own error is
        // a sixth of the third derivative (at most 120 peak / h^3) times step^2: 2e-5 of peak / h.
        EXPECT_NEAR(kernel.gradient_over_distance(r) * r, difference, 2e-4f * kernel.peak / h) << q;
    }
    EXPECT_EQ(kernel.value(h), 0.0f);
    EXPECT_EQ(kernel.gradient_over_distance(h), 0.0f);
    EXPECT_EQ(kernel.value(2.0f * h), 0.0f);
}

TEST(FluidKernel, LatticeSumIsReciprocalVolume) {
    const FluidKernel kernel(h);
    // By hand for h of two spacings: one at 0, 6 at h / 2, 12 at h / sqrt(2), 8 at h sqrt(3) / 2.
    const float sum = kernel.value(0.0f) + 6.0f * kernel.value(0.5f * h) +
                      12.0f * kernel.value(h / std::sqrt(2.0f)) + 8.0f * kernel.value(h * std::sqrt(0.75f));
    EXPECT_NEAR(kernel.lattice_volume(0.5f * h) * sum, 1.0f, 1e-5f);
}

TEST(Cohesion, StrengthReproducesSurfaceTension) {
    const float volume = 1e-9f;
    const float strength = cohesion_strength(0.05f, volume, h);
    const double tension =
        pi / 8.0 / (static_cast<double>(volume) * static_cast<double>(volume)) * radial([&](double r) {
            return r * r * r * r * static_cast<double>(strength) * cohesion_shape(r / static_cast<double>(h));
        });
    EXPECT_NEAR(tension, 0.05, 1e-5);
    EXPECT_LT(cohesion_shape(0.2f), 0.0f);
    EXPECT_EQ(cohesion_shape(0.25f), 0.0f);
    EXPECT_EQ(cohesion_shape(0.5f), 1.0f);
    EXPECT_EQ(cohesion_shape(1.0f), 0.0f);
}

TEST(WallTable, HalfSpaceMatchesBruteForceSum) {
    // Sums over cells of h / 40 behind the wall. A boundary cell is wrong by at most half, and a plane of
    // cells at the surface holds up to 1.5 / 40 of the kernel: 2 % of the largest value.
    const FluidKernel kernel(h);
    const WallTable table(kernel);
    constexpr int cells = 40;
    const double w = static_cast<double>(h) / cells;
    for (const float q : {0.0f, 0.1f, 0.25f, 0.5f, 0.8f}) {
        double density = 0.0, adhesion = 0.0, drag = 0.0;
        for (int x = -cells; x < cells; ++x) {
            for (int y = -cells; y < cells; ++y) {
                for (int z = 0; z < cells; ++z) {
                    const Vec3d at(w * (x + 0.5), w * (y + 0.5), -static_cast<double>(q * h) - w * (z + 0.5));
                    const double r = at.norm();
                    if (r < static_cast<double>(h)) {
                        const auto rf = static_cast<float>(r);
                        density += static_cast<double>(kernel.value(rf)) * w * w * w;
                        adhesion += cohesion_shape(r / static_cast<double>(h)) * -at.z() / r * w * w * w;
                        drag -= static_cast<double>(kernel.gradient_over_distance(rf)) * at.x() * at.x() /
                                (r * r) * w * w * w;
                    }
                }
            }
        }
        const WallTerms terms = table.at(q * h);
        EXPECT_NEAR(terms.density, density, 0.01) << q;
        EXPECT_NEAR(terms.adhesion, adhesion, 0.02 * std::pow(h, 3)) << q;
        // drag is a moment of W' weaker by r^2; its whole integral is 1 / h^2 times 10.5 (by hand).
        EXPECT_NEAR(terms.drag * h * h, drag * h * h, 0.1) << q;
    }
    EXPECT_NEAR(table.at(0.0f).density, 0.5f, 1e-5f);
    EXPECT_EQ(table.at(-1e-3f).density, table.at(0.0f).density);
    EXPECT_EQ(table.at(h).density, 0.0f);
    EXPECT_EQ(table.at(1.0f).gradient, 0.0f);
}

TEST(WallTable, GradientIsDensityDerivative) {
    const WallTable table{FluidKernel(h)};
    const float step = h / 128.0f;
    for (float q = 0.125f; q < 0.9f; q += 0.125f) {
        const float slope = (table.at(q * h + step).density - table.at(q * h - step).density) / (2.0f * step);
        // Entries a 128th of h apart: the slope over two of them is off by the curvature's change, below 30 /
        // h^3 times step^2 / 6.
        EXPECT_NEAR(table.at(q * h).gradient * h, slope * h, 1e-3f) << q;
    }
}

}  // namespace
}  // namespace eti::pbd
