// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/mesh/check.hpp"
#include "common/model/tools/tools.hpp"

namespace eti {
namespace {

class LaryngoscopeBlades : public testing::TestWithParam<Blade> {
  protected:
    Laryngoscope scope_ = make_laryngoscope(GetParam());
    TriangleMesh mesh_ = laryngoscope_mesh(scope_);
};

TEST_P(LaryngoscopeBlades, CapsuleTipIsTheBladeTip) {
    const Capsule& distal = scope_.capsules[2];
    EXPECT_NEAR(distal.b.z() + distal.radius, scope_.blade_length, 1e-7f);
    EXPECT_NEAR(scope_.tip().z(), scope_.blade_length, 1e-7f);
}

TEST_P(LaryngoscopeBlades, SurfaceIsSoundAndConnected) {
    const MeshReport report = check(mesh_);
    EXPECT_TRUE(report.is_valid()) << report.describe();
    EXPECT_EQ(report.components, 1u);
    EXPECT_EQ(report.euler_characteristic, 2);
}

TEST_P(LaryngoscopeBlades, VolumeMatchesHandleAndPlate) {
    // Handle: a cylinder of radius 9 mm from 24 to 126 mm; heel and plate add, the rounded edge takes less.
    const double handle = 3.14159265 * 0.009 * 0.009 * 0.102;
    // Plate and flange: at most 10 mm by 1.5 mm plus 2.5 mm by 1.2 mm over the blade's length; neck and heel
    // lie within a cylinder of radius 9 mm and 24 mm length.
    const double rest = (0.010 * 0.0015 + 0.0025 * 0.0012) * 0.1 + 3.14159265 * 0.009 * 0.009 * 0.024;
    const double volume = check(mesh_).volume;
    EXPECT_GT(volume, handle * 0.98);
    EXPECT_LT(volume, handle + rest);
}

TEST_P(LaryngoscopeBlades, EndsAtTheTip) {
    float tip = 0;
    for (const Vec3f& v : mesh_.vertices) {
        tip = std::max(tip, v.z());
    }
    EXPECT_NEAR(tip, scope_.blade_length, 1e-6f);
}

TEST_P(LaryngoscopeBlades, ChannelBeneathThePlateIsOpen) {
    // Lines that the eye and the tube use: along the blade, right of the flange and beneath the plate's
    // lower face, which lies 1.5 mm of plate and 1.2 mm of crown below the capsule's surface.
    for (const Vec3f& v : mesh_.vertices) {
        if (v.z() < 0.02f) {
            continue;
        }
        const bool flange = v.x() > 1.8e-3f;
        EXPECT_TRUE(flange || v.y() > scope_.capsules[2].radius - 2.7e-3f - 1e-6f)
            << "a vertex at " << v.transpose() << " stands in the line of sight";
        EXPECT_LT(v.y(), scope_.capsules[1].radius + 1e-6f) << "above the capsule at " << v.transpose();
        EXPECT_LE(std::fabs(v.x()), scope_.blade == Blade::miller_0 ? 4.01e-3f : 5.01e-3f);
    }
}

INSTANTIATE_TEST_SUITE_P(Blades, LaryngoscopeBlades, testing::Values(Blade::miller_0, Blade::miller_1),
                         [](const auto& blade) {
                             return blade.param == Blade::miller_0 ? "Miller0" : "Miller1";
                         });

TEST(Laryngoscope, BladesHaveTheCataloguesLengths) {
    EXPECT_FLOAT_EQ(make_laryngoscope(Blade::miller_0).blade_length, 0.076f);
    EXPECT_FLOAT_EQ(make_laryngoscope(Blade::miller_1).blade_length, 0.100f);
}

}  // namespace
}  // namespace eti
