// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>

#include "common/model/tools/tools.hpp"

namespace eti {
namespace {

TEST(Tube, OuterDiametersOfTheThreeNewbornSizes) {
    EXPECT_NEAR(outer_diameter_of(2.5e-3f), 3.6e-3f, 1e-8f);
    EXPECT_NEAR(outer_diameter_of(3.0e-3f), 4.2e-3f, 1e-8f);
    EXPECT_NEAR(outer_diameter_of(3.5e-3f), 4.9e-3f, 1e-8f);
}

TEST(Tube, BendingStiffnessMatchesAnnularSection) {
    // Second moment of area about a diameter by integrating y^2 dA over the ring; the midpoint rule in
    // radius with n rings errs by (b-a)^3 max|f''| / (24 n^2), here below 1e-6 of the value.
    Tube tube;
    constexpr int rings = 1000;
    const double inner = 0.5 * static_cast<double>(tube.inner_diameter);
    const double width = (0.5 * static_cast<double>(tube.outer_diameter) - inner) / rings;
    double moment = 0;
    for (int i = 0; i < rings; ++i) {
        moment += 3.14159265358979 * std::pow(inner + (i + 0.5) * width, 3) * width;
    }
    // Single precision: four roundings to the fourth power and a difference that loses less than two bits.
    EXPECT_NEAR(static_cast<double>(tube.bending_stiffness()) / (15e6 * moment), 1.0, 4e-6);
}

TEST(Tube, PvcStiffnessIsInPublishedRange) {
    // 10-20 MPa give 0.6-1.3, 1.1-2.3 and 2.1-4.2 x 1e-4 N m^2 for 2.5, 3.0 and 3.5 mm, rounded to one
    // decimal.
    const float low[] = {0.6e-4f, 1.1e-4f, 2.1e-4f};
    const float high[] = {1.3e-4f, 2.3e-4f, 4.2e-4f};
    for (int i = 0; i < 3; ++i) {
        Tube tube;
        tube.inner_diameter = 2.5e-3f + 0.5e-3f * static_cast<float>(i);
        tube.outer_diameter = outer_diameter_of(tube.inner_diameter);
        tube.youngs_modulus = 10e6f;
        EXPECT_NEAR(tube.bending_stiffness(), low[i], 0.051e-4f);
        tube.youngs_modulus = 20e6f;
        EXPECT_NEAR(tube.bending_stiffness(), high[i], 0.051e-4f);
    }
}

}  // namespace
}  // namespace eti
