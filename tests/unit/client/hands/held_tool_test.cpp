// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/held_tool.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti {
namespace {

using client::HandLimits;
using client::HeldTool;
using client::Lead;

constexpr float held_tool_dt = 1.0f / 180.0f;
constexpr float held_tool_tolerance = 1e-6f;  // [m], of floats of a metre

RigidTransform somewhere() {
    return {quaternion_from({0.3f, -0.2f, 0.5f}), {0.05f, -0.1f, 0.08f}};
}

HeldTool blade() {
    return {0.1f, 0.0f, somewhere()};
}

void follow(HeldTool& tool, int steps, const Lead& lead = {}) {
    for (int i = 0; i < steps; ++i) {
        tool.advance(held_tool_dt, lead);
    }
}

TEST(HeldTool, FollowsAStraightWayNoFasterThanAHand) {
    HeldTool tool = blade();
    const Vec3f from = tool.tip(), way(0.0f, 0.024f, 0.0f);
    tool.move(way);
    follow(tool, 18);  // 0.1 s at 0.12 m/s
    EXPECT_NEAR((tool.tip() - from - 0.012f * Vec3f::UnitY()).norm(), 0.0f, held_tool_tolerance);
    follow(tool, 30);
    EXPECT_NEAR((tool.tip() - from - way).norm(), 0.0f, held_tool_tolerance) << "and arrives";
}

TEST(HeldTool, WhatWasAskedForRunsNoFartherAhead) {
    HeldTool tool = blade();
    tool.move({1.0f, 0.0f, 0.0f});
    tool.advance(held_tool_dt, {});
    EXPECT_LE((tool.wanted().translation - somewhere().translation).norm(),
              HandLimits().ahead + held_tool_tolerance);
}

TEST(HeldTool, TurnsAndSwingsOfTheGripLeaveTheTip) {
    HeldTool tool = blade();
    const Vec3f tip = tool.tip();
    tool.turn({0.2f, 0.1f, -0.3f});
    tool.swing_grip({0.01f, 0.02f, 0.0f});
    follow(tool, 200);
    EXPECT_NEAR((tool.tip() - tip).norm(), 0.0f, 2 * held_tool_tolerance);
    EXPECT_GT((tool.pose().translation - somewhere().translation).norm(), 5e-3f);
}

TEST(HeldTool, ASmallSwingCarriesTheGripWhereTheMouseGoes) {
    HeldTool tool = blade();
    // Across the tool: along it no turn moves the grip.
    const Vec3f across = somewhere().rotation * Vec3f(1e-3f, 0.5e-3f, 0.0f);
    tool.swing_grip(across);
    // An arc of 1.1 mm on a radius of 100 mm leaves its tangent by 1.1^2 / 200 mm.
    EXPECT_NEAR((tool.wanted().translation - somewhere().translation - across).norm(), 6e-6f, 3e-6f);
}

TEST(HeldTool, ASwingOfTheTipLeavesItsPivot) {
    HeldTool tool = blade();
    const Vec3f lips = tool.along(0.04f);
    tool.swing_tip(lips, {0.004f, 0.0f, 0.003f});
    EXPECT_NEAR((tool.along(0.04f) - lips).norm(), 0.0f, held_tool_tolerance);
}

TEST(HeldTool, ACurvedTubeSlidesAlongItsArc) {
    constexpr float radius = 0.07f, length = 0.1f;
    HeldTool tube(length, 1.0f / radius, somewhere());
    const Vec3f centre = somewhere() * Vec3f(0.0f, radius, 0.0f);
    const Vec3f tip = tube.tip();
    tube.slide(0.02f);
    follow(tube, 200);
    EXPECT_NEAR((tube.tip() - centre).norm(), radius, 2 * held_tool_tolerance);
    EXPECT_NEAR((tube.pose().translation - centre).norm(), radius, 2 * held_tool_tolerance);
    // A chord of 20 mm of arc.
    EXPECT_NEAR((tube.tip() - tip).norm(), 2 * radius * std::sin(0.01f / radius), 2 * held_tool_tolerance);
    EXPECT_NEAR(tube.length_until(tip), length - 0.02f, 2 * held_tool_tolerance);
}

TEST(HeldTool, LiftsAlongTheHandle) {
    HeldTool tool = blade();
    tool.lift(0.009f);
    follow(tool, 60);
    EXPECT_NEAR((somewhere().inverse() * tool.pose().translation - Vec3f(0, 0.009f, 0)).norm(), 0.0f,
                held_tool_tolerance);
}

TEST(HeldTool, PressesOnLessTheFartherItIsAheadAndStops) {
    const HandLimits limits;
    const Vec3f way(0.0f, 0.02f, 0.01f);
    const auto step = [&](float lead) {
        HeldTool tool = blade();
        tool.move(way);
        tool.advance(held_tool_dt, {{0.0f, lead, 0.0f}, Vec3f::Zero()});
        return Vec3f(tool.wanted().translation - tool.pose().translation +
                     (tool.pose().translation - somewhere().translation));
    };
    EXPECT_NEAR((step(0.5f * limits.lead) - way).norm(), 0.0f, held_tool_tolerance) << "half of it is free";
    EXPECT_NEAR(step(0.75f * limits.lead).y(), 0.5f * way.y(), held_tool_tolerance) << "then less and less";
    EXPECT_NEAR(step(limits.lead).y(), 0.0f, held_tool_tolerance) << "to nothing";
    EXPECT_NEAR(step(limits.lead).z(), way.z(), held_tool_tolerance) << "aside it goes on";
    EXPECT_NEAR(step(-limits.lead).y(), way.y(), held_tool_tolerance) << "and back";
}

TEST(HeldTool, ComesBackAtOnceHoweverLongItWasPushedOn) {
    HeldTool tool = blade();
    const Lead wall{{0.0f, HandLimits().lead, 0.0f}, Vec3f::Zero()};
    for (int i = 0; i < 100; ++i) {
        tool.move({0.0f, 0.01f, 0.0f});
        tool.advance(held_tool_dt, wall);
    }
    const float stopped = tool.pose().translation.y();
    EXPECT_NEAR(stopped, somewhere().translation.y(), held_tool_tolerance);
    tool.move({0.0f, -0.0005f, 0.0f});
    tool.advance(held_tool_dt, wall);
    EXPECT_NEAR(tool.pose().translation.y() - stopped, -0.0005f, held_tool_tolerance);
}

TEST(HeldTool, YieldsWhereItIsTooFarAheadWithItsTimeConstant) {
    const HandLimits limits;
    HeldTool tool = blade();
    // A wall that does not move: the lead is where the hand is, less where that is.
    const float wall = somewhere().translation.y() - 0.01f;
    const int steps = static_cast<int>(std::round(limits.give_way_time / held_tool_dt));
    for (int i = 0; i < steps; ++i) {
        tool.advance(held_tool_dt, {{0.0f, tool.pose().translation.y() - wall, 0.0f}, Vec3f::Zero()});
    }
    const float excess = tool.pose().translation.y() - wall - limits.lead;
    // Explicit steps of 1/27 of the time constant: (1 - 1/27)^27 instead of 1/e.
    EXPECT_NEAR(excess, (0.01f - limits.lead) * std::pow(1.0f - held_tool_dt / limits.give_way_time, steps),
                2 * held_tool_tolerance);
}

TEST(HeldTool, ANumberThatIsNoneMovesNothing) {
    HeldTool tool = blade();
    tool.move({0.0f, 0.01f, 0.0f});
    tool.advance(held_tool_dt, {{NAN, 0.0f, 0.0f}, Vec3f::Zero()});
    tool.advance(NAN, {});
    EXPECT_EQ((tool.pose().translation - somewhere().translation).norm(), 0.0f);
}

}  // namespace
}  // namespace eti
