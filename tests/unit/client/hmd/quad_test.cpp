// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/quad.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace eti {
namespace {

TEST(PanelRaycast, FindsPointOnRotatedPanel) {
    const Quatf turn(Eigen::AngleAxisf(-0.7f, Vec3f(0.1f, 1.0f, 0.2f).normalized()));
    const hmd::Quad panel{RigidTransform::from(turn, {0.6f, -0.1f, -0.7f}), 0.5f, 0.8f};
    for (const Vec3f& from : {Vec3f(0.0f, 0.0f, 0.0f), Vec3f(0.3f, -0.4f, 0.1f), Vec3f(-0.2f, 0.2f, -0.1f)}) {
        // A tenth from the left, three quarters down.
        const Vec3f there = panel.pose * Vec3f(-0.4f * panel.width, -0.25f * panel.height, 0.0f);
        const RigidTransform aim =
            RigidTransform::from(Quatf::FromTwoVectors(-Vec3f::UnitZ(), there - from), from);
        const auto at = hmd::intersect_quad(panel, aim);
        ASSERT_TRUE(at);
        EXPECT_NEAR(at->across, 0.1f, 1e-5f);
        EXPECT_NEAR(at->down, 0.75f, 1e-5f);
        EXPECT_NEAR(at->distance, (there - from).norm(), 1e-5f);
        EXPECT_TRUE(at->inside());
    }
}

TEST(PanelRaycast, MissesFromBehindOrParallel) {
    const hmd::Quad panel{RigidTransform::from(Quatf::Identity(), {0.0f, 0.0f, -1.0f}), 0.5f, 0.5f};
    EXPECT_FALSE(hmd::intersect_quad(panel, RigidTransform::from(Quatf::Identity(), {0.0f, 0.0f, -2.0f})));
    const Quatf back(Eigen::AngleAxisf(std::numbers::pi_v<float>, Vec3f::UnitY()));
    EXPECT_FALSE(hmd::intersect_quad(panel, RigidTransform::from(back, Vec3f::Zero()))) << "away from it";
    const Quatf aside(Eigen::AngleAxisf(0.5f * std::numbers::pi_v<float>, Vec3f::UnitY()));
    EXPECT_FALSE(hmd::intersect_quad(panel, RigidTransform::from(aside, Vec3f::Zero())));
}

}  // namespace
}  // namespace eti
