// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/convert.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>

namespace eti::bus {
namespace {

TEST(Convert, PoseSurvivesRoundTrip) {
    const RigidTransform pose{quaternion_from({0.3f, -0.2f, 0.9f}), {0.01f, -0.02f, 0.3f}};
    const RigidTransform back = from_msg(to_msg(pose));
    EXPECT_EQ(back.translation, pose.translation);
    // from_msg normalises: one rounding per component.
    EXPECT_LT((back.rotation.coeffs() - pose.rotation.coeffs()).norm(),
              4 * std::numeric_limits<float>::epsilon());
    EXPECT_TRUE(valid_pose(to_msg(pose)));
}

TEST(Convert, InvalidQuaternionBecomesIdentity) {
    const float bad = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    for (const Quatf& q : {Quatf(0, 0, 0, 0), Quatf(bad, 0, 0, 1), Quatf(infinite, 0, 0, 1)}) {
        EXPECT_TRUE(from_msg(to_msg(q)).isApprox(Quatf::Identity()));
        EXPECT_FALSE(valid_pose(to_msg(RigidTransform{q, Vec3f::Zero()})));
    }
    EXPECT_FALSE(valid_pose(to_msg(RigidTransform{Quatf::Identity(), {0, bad, 0}})));
    EXPECT_FALSE(valid_pose(to_msg(RigidTransform{Quatf(2, 0, 0, 0), Vec3f::Zero()})));
    EXPECT_TRUE(from_msg(to_msg(Quatf(0, 2, 0, 0))).isApprox(Quatf(0, 1, 0, 0)));
}

TEST(Convert, HeaderCarriesSystemClockTime) {
    const auto before = std::chrono::system_clock::now().time_since_epoch();
    const msg::Header header = make_header(5, 6);
    const auto after = std::chrono::system_clock::now().time_since_epoch();
    EXPECT_EQ(header.simulation_time_ns(), 5u);
    EXPECT_EQ(header.number(), 6u);
    EXPECT_GE(header.send_time_ns(), static_cast<std::uint64_t>(std::chrono::nanoseconds(before).count()));
    EXPECT_LE(header.send_time_ns(), static_cast<std::uint64_t>(std::chrono::nanoseconds(after).count()));
}

}  // namespace
}  // namespace eti::bus
