// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/gimbal_force.hpp"

#include <gtest/gtest.h>

#include "common/math/random.hpp"

namespace eti::devices {
namespace {

Vec3f any(Random& random) {
    return {random.normal(), random.normal(), random.normal()};
}

// The moment about the contact is that of the wrench, except for the component along the arm, which no force
// can produce.
TEST(GimbalForce, HasTheSameMomentAboutTheContact) {
    Random random(2);
    for (int i = 0; i < 1000; ++i) {
        const Vec3f contact = 0.05f * any(random), origin = 0.05f * any(random);
        const Vec3f arm = 0.01f * any(random) + Vec3f(0.1f, 0, 0);
        const Wrench wrench{any(random), 0.1f * any(random)};
        const Vec3f force = gimbal_force(wrench, {}, origin, contact, contact + arm);
        const Vec3f wanted = wrench.torque + Vec3f(origin - contact).cross(wrench.force);
        const Vec3f along = arm.normalized();
        const Vec3f square = wanted - along.dot(wanted) * along;
        // Products of floats of about 1 N, 0.3 N m and 0.1 m: some 1e-7 each, a dozen of them.
        EXPECT_LT((arm.cross(force) - square).norm(), 2e-6f * (1.0f + wanted.norm()));
        EXPECT_NEAR(force.dot(along), wrench.force.dot(along), 1e-5f) << "along the arm nothing is added";
    }
}

TEST(GimbalForce, PureForceThroughGimbalIsUnchanged) {
    const Wrench wrench{{1, 2, 3}, Vec3f::Zero()};
    const Vec3f gimbal(0.1f, 0.2f, 0.3f);
    EXPECT_LT((gimbal_force(wrench, {}, gimbal, {0, 0, 0}, gimbal) - wrench.force).norm(), 1e-6f);
}

TEST(GimbalForce, IsBoundedForAShortArm) {
    const Wrench wrench{Vec3f::Zero(), {0.3f, 0, 0}};
    for (const float arm : {0.0f, 1e-6f, 1e-3f, 0.02f, 0.1f}) {
        EXPECT_LE(gimbal_force(wrench, {}, Vec3f::Zero(), Vec3f::Zero(), {0, arm, 0}).norm(),
                  0.3f / 0.02f * 1.001f);
    }
}

// A blade that presses tissue with 6 N, 100 mm from a gum that it only touches, with nothing, a hundredth of
// a newton, and so on: the force at the gimbal changes by no more than the gum's load, twice (its force, and
// its torque about the contact, of which this one has none).
TEST(GimbalForce, ContactThatBearsNothingChangesNothing) {
    const Wrench tissue{{0, 0, 6.0f}, Vec3f::Zero()};
    const Vec3f origin = Vec3f::Zero(), contact(0, 0.1f, 0), gimbal(0, 0.16f, 0);
    EXPECT_EQ((gimbal_force({}, tissue, origin, contact, gimbal) - tissue.force).norm(), 0.0f);
    for (const float load : {0.01f, 0.1f, 1.0f}) {
        const Wrench shell{{0, 0, -load}, contact.cross(Vec3f(0, 0, -load))};
        const Vec3f force = gimbal_force(shell, tissue, origin, contact, gimbal);
        EXPECT_LE((force - tissue.force).norm(), 2.0f * load * 1.001f) << load;
        EXPECT_GT((force - tissue.force).norm(), 0.0f);
    }
}

}  // namespace
}  // namespace eti::devices
