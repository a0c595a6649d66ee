// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/headset/laser_pointer.hpp"

#include <gtest/gtest.h>

#include <cfloat>

namespace eti {
namespace {

// A square of 1 m, 2 m ahead, facing a viewer at the origin.
const hmd::Quad panel_ahead{RigidTransform::from(Quatf::Identity(), {0.0f, 0.0f, -2.0f}), 1.0f, 1.0f};

// From the origin to a point of the panel's plane.
RigidTransform towards(float x, float y) {
    return RigidTransform::from(Quatf::FromTwoVectors(-Vec3f::UnitZ(), Vec3f(x, y, -2.0f)), Vec3f::Zero());
}

struct Said {
    panel::Pointer pointer;
    float sucks;
};

class Laser : public ::testing::Test {
  protected:
    // Of the right hand.
    Said follow(const RigidTransform& aim, float trigger, const hmd::Quad* panel = &panel_ahead) {
        hmd::HandInput hands;
        hands.hands[1] = {aim, trigger};
        laser_.follow(panel, hands);
        return {laser_.pointer(100, 100), hands.hands[1].trigger};
    }
    client::LaserPointer laser_;
};

TEST_F(Laser, PointerIsAtPanelIntersection) {
    const Said at = follow(towards(0.25f, 0.4f), 0.0f);
    EXPECT_NEAR(at.pointer.x, 75.0f, 1e-3f);
    EXPECT_NEAR(at.pointer.y, 10.0f, 1e-3f);
    EXPECT_FALSE(at.pointer.down);
    ASSERT_EQ(laser_.rays().size(), 1u);
    EXPECT_LT((laser_.rays()[0].to - Vec3f(0.25f, 0.4f, -2.0f)).norm(), 1e-5f);
    EXPECT_EQ(follow(towards(0.51f, 0.0f), 0.0f).pointer.x, -FLT_MAX) << "beside it";
    EXPECT_NEAR((laser_.rays()[0].to - laser_.rays()[0].from).norm(), 1.5f, 1e-5f);
    // From behind, and pointing away from it.
    const RigidTransform behind =
        RigidTransform::from(Quatf(Eigen::AngleAxisf(3.14159265f, Vec3f::UnitY())), {0.0f, 0.0f, -4.0f});
    EXPECT_EQ(follow(behind, 0.0f).pointer.x, -FLT_MAX);
    EXPECT_EQ(follow(RigidTransform::from(Quatf::Identity(), {0.0f, 0.0f, -4.0f}), 0.0f).pointer.x, -FLT_MAX);
}

TEST_F(Laser, TriggerClicksOnPanelAndSuctionsElsewhere) {
    Said at = follow(towards(0.0f, 0.0f), 1.0f);
    EXPECT_TRUE(at.pointer.down);
    EXPECT_EQ(at.sucks, 0.0f);
    // A held slider stays held beyond the panel's edge.
    at = follow(towards(0.8f, 0.0f), 1.0f);
    EXPECT_TRUE(at.pointer.down);
    EXPECT_NEAR(at.pointer.x, 130.0f, 1e-3f);
    EXPECT_EQ(at.sucks, 0.0f);
    at = follow(towards(0.8f, 0.0f), 0.0f);
    EXPECT_FALSE(at.pointer.down);
    // With the trigger pressed outside the panel it applies suction, even when moved over the panel.
    EXPECT_EQ(follow(towards(0.8f, 0.0f), 1.0f).sucks, 1.0f);
    at = follow(towards(0.0f, 0.0f), 1.0f);
    EXPECT_EQ(at.sucks, 1.0f);
    EXPECT_FALSE(at.pointer.down);
}

TEST_F(Laser, HasNoPointerWithoutPanelOrHand) {
    EXPECT_EQ(follow(towards(0.0f, 0.0f), 1.0f, nullptr).sucks, 1.0f);
    EXPECT_TRUE(laser_.rays().empty());
    hmd::HandInput unknown;
    unknown.hands[1].trigger = 0.0f;
    laser_.follow(&panel_ahead, unknown);
    EXPECT_EQ(laser_.pointer(100, 100).x, -FLT_MAX);
    EXPECT_TRUE(laser_.rays().empty());
}

TEST_F(Laser, LeftHandPointsIfRightMissesPanel) {
    hmd::HandInput both;
    both.hands[0] = {towards(-0.25f, 0.0f), 0.0f};
    both.hands[1] = {towards(0.25f, 0.0f), 0.0f};
    laser_.follow(&panel_ahead, both);
    EXPECT_NEAR(laser_.pointer(100, 100).x, 75.0f, 1e-3f);
    both.hands[1].aim = towards(0.9f, 0.0f);
    both.hands[0].trigger = 1.0f;
    laser_.follow(&panel_ahead, both);
    EXPECT_NEAR(laser_.pointer(100, 100).x, 25.0f, 1e-3f);
    EXPECT_TRUE(laser_.pointer(100, 100).down);
    EXPECT_EQ(laser_.rays().size(), 2u);
}

}  // namespace
}  // namespace eti
