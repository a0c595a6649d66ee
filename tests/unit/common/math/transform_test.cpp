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

TEST(IsRigid, RequiresFiniteValuesAndUnitQuaternion) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    const float endless = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(is_rigid({}));
    EXPECT_TRUE(is_rigid({Quatf(1.009f, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_rigid({Quatf(1.011f, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_rigid({Quatf(0, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_rigid({Quatf(none, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_rigid({Quatf(endless, 0, 0, 0), Vec3f::Zero()}));
    EXPECT_FALSE(is_rigid({Quatf::Identity(), Vec3f(0, none, 0)}));
    EXPECT_FALSE(is_rigid({Quatf::Identity(), Vec3f(0, 0, endless)}));
}

}  // namespace
}  // namespace eti
