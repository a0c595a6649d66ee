// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/math/transform.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace eti {
namespace {

TEST(Interpolate, IsLinearWithConstantTurnRate) {
    const float quarter = std::numbers::pi_v<float> / 2.0f;
    const RigidTransform from;
    const RigidTransform to{quaternion_from({0, 0, quarter}), {0.1f, 0, -0.2f}};
    const RigidTransform third = interpolate(from, to, 1.0f / 3.0f);
    EXPECT_LT((third.translation - Vec3f(0.1f, 0, -0.2f) / 3.0f).norm(), 1e-8f);
    EXPECT_LT((rotation_vector(third.rotation) - Vec3f(0, 0, quarter / 3.0f)).norm(), 1e-6f);
    EXPECT_LT((interpolate(from, to, 1.0f).translation - to.translation).norm(), 1e-8f);
}

TEST(IsValidPose, RequiresFiniteUnitAndNearness) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    const float endless = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(is_valid_pose({}));
    EXPECT_TRUE(is_valid_pose({Quatf(1.0009f, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_valid_pose({Quatf(1.0011f, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_valid_pose({Quatf(0, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_valid_pose({Quatf(none, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_valid_pose({Quatf(endless, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_valid_pose({Quatf::Identity(), Vec3f(0, none, 0)}));
    EXPECT_FALSE(is_valid_pose({Quatf::Identity(), Vec3f(0, 0, endless)}));
    EXPECT_FALSE(is_valid_pose({Quatf::Identity(), Vec3f(0, 2, 0)}, 1.0f));
}

}  // namespace
}  // namespace eti
