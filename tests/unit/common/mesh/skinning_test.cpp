// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/skinning.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace eti {
namespace {

TEST(HasMoved, IsTrueBeyondTheThreshold) {
    const FramePose rest;
    FramePose now = rest;
    EXPECT_FALSE(has_moved(rest, now));
    now.centre.x() = 0.9f * frame_shift_quantum;
    EXPECT_FALSE(has_moved(rest, now));
    now.centre.x() = 1.1f * frame_shift_quantum;
    EXPECT_TRUE(has_moved(rest, now));
    now = {Vec3f::Zero(), quaternion_from({0, 0.9f * frame_turn_quantum, 0})};
    EXPECT_FALSE(has_moved(rest, now));
    now.rotation = quaternion_from({0, 1.1f * frame_turn_quantum, 0});
    EXPECT_TRUE(has_moved(rest, now));
}

TEST(HasMoved, IsTrueForNanFrame) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(has_moved({}, {Vec3f(none, 0, 0), Quatf::Identity()}));
    EXPECT_TRUE(has_moved({}, {Vec3f::Zero(), Quatf(none, 0, 0, 0)}));
}

}  // namespace
}  // namespace eti
