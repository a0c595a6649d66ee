// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/room.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace eti::hmd {
namespace {

// Patient: x to its left, y posterior, z to its head. World: x to the trainee's right, y up, z back.
TEST(Room, PatientIsSupineWithHeadTowardsTrainee) {
    const Room room{.gum = {0.1f, -0.2f, -0.3f}};
    const RigidTransform patient = room.patient(0.0f);
    const auto turned = [&](const Vec3f& direction) { return Vec3f(patient.rotation * direction); };
    EXPECT_LT((patient * Vec3f::Zero() - room.gum).norm(), 1e-6f);
    EXPECT_LT((turned(Vec3f::UnitY()) - Vec3f(0.0f, -1.0f, 0.0f)).norm(), 1e-6f) << "its back is down";
    EXPECT_LT((turned(Vec3f::UnitZ()) - Vec3f(0.0f, 0.0f, 1.0f)).norm(), 1e-6f) << "its head is here";
    EXPECT_LT((turned(Vec3f::UnitX()) - Vec3f(-1.0f, 0.0f, 0.0f)).norm(), 1e-6f)
        << "its left hand lies on the trainee's left";
}

TEST(Room, HeadUpTiltRotatesPatientAboutMouth) {
    const Room room;
    const float angle = 0.25f;
    const RigidTransform patient = room.patient(angle);
    EXPECT_LT((patient * Vec3f::Zero() - room.gum).norm(), 1e-6f);
    const Vec3f crown = patient * Vec3f(0.0f, 0.0f, 0.1f) - room.gum;
    EXPECT_NEAR(crown.y(), 0.1f * std::sin(angle), 1e-6f);
    EXPECT_NEAR(crown.z(), 0.1f * std::cos(angle), 1e-6f);
    const RigidTransform unknown = room.patient(std::numeric_limits<float>::quiet_NaN());
    EXPECT_NEAR((unknown * Vec3f(0.0f, 0.0f, 0.1f)).y(), room.gum.y(), 1e-6f);
}

}  // namespace
}  // namespace eti::hmd
