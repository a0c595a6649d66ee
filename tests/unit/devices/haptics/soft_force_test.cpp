// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/soft_force.hpp"

#include <gtest/gtest.h>

namespace eti::devices {
namespace {

// One capsule along z from 0 to 0.1 m, 4 mm thick.
const std::array<Capsule, 1> blade = {Capsule{{0, 0, 0}, {0, 0, 0.1f}, 4e-3f}};

std::array<float, tissue_count> stiffness(float tongue, float epiglottis) {
    std::array<float, tissue_count> out{};
    out[static_cast<std::size_t>(Tissue::tongue)] = tongue;
    out[static_cast<std::size_t>(Tissue::epiglottis)] = epiglottis;
    return out;
}

TEST(Touches, SphereAgainstCapsule) {
    const RigidTransform pose{Quatf(Eigen::AngleAxisf(std::numbers::pi_v<float> / 2, Vec3f::UnitX())),
                              {0.5f, 0, 0}};
    // The rotation maps the tool's z to -y: the capsule runs from (0.5, 0, 0) to (0.5, -0.1, 0).
    const auto at = [](float x, float y, float z) {
        return TissuePoint{{x, y, z}, {}, 1e-3f, Tissue::tongue};
    };
    EXPECT_TRUE(touches(at(0.5f, -0.05f, 4.9e-3f), blade, pose));
    EXPECT_FALSE(touches(at(0.5f, -0.05f, 5.1e-3f), blade, pose));
    EXPECT_TRUE(touches(at(0.5f, 4.9e-3f, 0), blade, pose));
    EXPECT_FALSE(touches(at(0.5f, 5.1e-3f, 0), blade, pose));
    EXPECT_TRUE(touches(at(0.5f, -0.1049f, 0), blade, pose));
    EXPECT_FALSE(touches(at(0.5f, -0.1051f, 0), blade, pose));
}

// By hand: two tongue particles displaced by 2 and 4 mm (mean 3 mm, at 100 N/m: 0.3 N up), one of the
// epiglottis by 5 mm (at 20 N/m: 0.1 N left); averaged over the two types: (0.05, 0.15, 0) N. Torque:
// tongue's mean position z = 60 mm: r x F = (-0.018, 0, 0); epiglottis's z = 90 mm: (0, 0.009, 0); averaged
// (-0.009, 0.0045, 0) N m.
TEST(DisplacementWrench, HandComputedCase) {
    const std::array<TissuePoint, 5> points = {{
        {{0, 0, 0.05f}, {0, 2e-3f, 0.05f}, 1e-3f, Tissue::tongue},
        {{0, 0, 0.07f}, {0, 4e-3f, 0.07f}, 1e-3f, Tissue::tongue},
        {{0, 0, 0.09f}, {5e-3f, 0, 0.09f}, 1e-3f, Tissue::epiglottis},
        {{0, 0.05f, 0.05f}, {0, 0.09f, 0.05f}, 1e-3f, Tissue::tongue},  // far from the blade
        {{0, 0, 0.05f}, {0, 0.01f, 0.05f}, 1e-3f, Tissue::skull},       // rigid: no stiffness here
    }};
    const Wrench wrench = displacement_wrench(points, blade, {}, stiffness(100.0f, 20.0f));
    // Sums of values below 0.1 in float: 1e-7 relative each.
    EXPECT_LT((wrench.force - Vec3f(0.05f, 0.15f, 0.0f)).norm(), 1e-6f);
    EXPECT_LT((wrench.torque - Vec3f(-0.009f, 0.0045f, 0.0f)).norm(), 1e-7f);
}

TEST(DisplacementWrench, ReevaluatesContactAtTheBladePose) {
    const std::array<TissuePoint, 1> points = {{{{0, 0, 0.05f}, {0, 3e-3f, 0.05f}, 1e-3f, Tissue::tongue}}};
    const auto k = stiffness(100.0f, 0.0f);
    EXPECT_NEAR(displacement_wrench(points, blade, {}, k).force.y(), 0.3f, 1e-6f);
    const RigidTransform away{Quatf::Identity(), {0, -5.5e-3f, 0}};
    EXPECT_EQ(displacement_wrench(points, blade, away, k).force.norm(), 0.0f);
    EXPECT_EQ(displacement_wrench({}, blade, {}, k).force.norm(), 0.0f);
}

/// Two particles on top of the blade, each pressed in by 2 mm, that push it down with 0.5 N each.
TissueReport pressed_tissue() {
    TissueReport report;
    report.points[0] = {{0, 5e-3f, 0.05f}, {0, 3e-3f, 0.05f}, 1e-3f, Tissue::tongue, {0, -0.5f, 0}};
    report.points[1] = {{0, 5e-3f, 0.07f}, {0, 3e-3f, 0.07f}, 1e-3f, Tissue::tongue, {0, -0.5f, 0}};
    report.count = 2;
    report.wrench = {{0, -1.0f, 0}, {0.06f, 0, 0}};
    return report;
}

TEST(ConstraintWrench, EqualsTheReportAtTheReportedPose) {
    const Wrench wrench = constraint_wrench(pressed_tissue(), {});
    EXPECT_LT((wrench.force - Vec3f(0, -1.0f, 0)).norm(), 1e-7f);
    EXPECT_LT((wrench.torque - Vec3f(0.06f, 0, 0)).norm(), 1e-8f);
}

// 0.5 N over 2 mm is 250 N/m per particle: 1 mm farther up adds 0.5 N in all, 2 mm back leaves zero, and
// farther out nothing pulls; the force no more than doubles.
TEST(ConstraintWrench, FollowsBladeWithTheTissueStiffness) {
    const auto at = [](float y) {
        return constraint_wrench(pressed_tissue(), {Quatf::Identity(), {0, y, 0}}).force.y();
    };
    EXPECT_NEAR(at(1e-3f), -1.5f, 1e-6f);
    EXPECT_NEAR(at(-1e-3f), -0.5f, 1e-6f);
    EXPECT_NEAR(at(-2e-3f), 0.0f, 1e-6f);
    EXPECT_NEAR(at(-9e-3f), 0.0f, 1e-6f);
    EXPECT_NEAR(at(9e-3f), -2.0f, 1e-6f);
    // Rotating the tip up about the handle presses the farther particle more.
    const Wrench turned =
        constraint_wrench(pressed_tissue(), {quaternion_from({-0.01f, 0, 0}), Vec3f::Zero()});
    EXPECT_NEAR(turned.force.y(), -1.0f - 250.0f * 0.01f * (0.05f + 0.07f), 1e-3f);
}

TEST(ConstraintWrench, ScalesWithRepresentedPoints) {
    TissueReport report = pressed_tissue();
    report.represents = 2.0f;
    report.wrench.force.y() = -2.0f;
    EXPECT_NEAR(constraint_wrench(report, {Quatf::Identity(), {0, 1e-3f, 0}}).force.y(), -3.0f, 1e-6f);
}

// E A / L with the figures named beside the table: 8 kPa * 3 cm^2 / 15 mm = 160 N/m.
TEST(TissueStiffness, IsZeroForRigidTypesOnly) {
    const auto& table = tissue_stiffness();
    EXPECT_NEAR(table[static_cast<std::size_t>(Tissue::tongue)], 160.0f, 0.1f);
    EXPECT_NEAR(table[static_cast<std::size_t>(Tissue::larynx)], 172.0f, 0.1f);
    for (const Tissue rigid : {Tissue::upper_gum, Tissue::lower_gum, Tissue::palate, Tissue::skull,
                               Tissue::mandible, Tissue::spine}) {
        EXPECT_EQ(table[static_cast<std::size_t>(rigid)], 0.0f) << name_of(rigid);
    }
}

}  // namespace
}  // namespace eti::devices
