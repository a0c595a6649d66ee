// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/device/coupling.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace eti {
namespace {

RigidTransform turned_at(float x, float turn) {
    return {quaternion_from(Vec3f(0, 0, turn)), Vec3f(x, 0, 0)};
}

TEST(Coupling, IsASpringAndADamperFromDeviceToProxy) {
    const CouplingSettings s;
    Motion device, proxy;
    proxy.pose = turned_at(0.002f, 0.1f);
    proxy.velocity = Vec3f(0, 0.05f, 0);
    proxy.angular_velocity = Vec3f(1, 0, 0);
    const Wrench wrench = coupling_wrench(device, proxy, s);
    EXPECT_TRUE(wrench.force.isApprox(Vec3f(0.002f * s.stiffness, 0.05f * s.damping, 0), 1e-6f));
    EXPECT_TRUE(wrench.torque.isApprox(Vec3f(s.rotational_damping, 0, 0.1f * s.rotational_stiffness), 1e-5f));
    // A wrench on the device that pulls it to the proxy; with both swapped it is the opposite.
    EXPECT_TRUE(coupling_wrench(proxy, device, s).force.isApprox(-wrench.force, 1e-6f));
}

TEST(Coupling, IsClampedToDeviceLimitKeepingDirection) {
    const CouplingSettings s;
    const Wrench big{Vec3f(30, 40, 0), Vec3f(0, 0, -9)};
    const Wrench wrench = clamp_to_limits(big, s);
    EXPECT_TRUE(wrench.force.isApprox(s.force_limit * Vec3f(0.6f, 0.8f, 0), 1e-6f));
    EXPECT_TRUE(wrench.torque.isApprox(Vec3f(0, 0, -s.torque_limit), 1e-6f));
    const Wrench small{Vec3f(1, 2, 3), Vec3f(0.1f, 0, 0)};
    EXPECT_EQ(clamp_to_limits(small, s).force, small.force);
    const Wrench bad{Vec3f(1, std::numeric_limits<float>::infinity(), 3), Vec3f(0.1f, 0, 0)};
    EXPECT_EQ(clamp_to_limits(bad, s).force, Vec3f::Zero());
    EXPECT_EQ(clamp_to_limits(bad, s).torque, Vec3f::Zero());
}

}  // namespace
}  // namespace eti
