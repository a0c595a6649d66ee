// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/device/held_tool.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace eti {
namespace {

constexpr float held_tool_dt = 1.0f / 180.0f;
constexpr float held_tool_tolerance = 1e-6f;  // [m], rounding of floats of a metre

RigidTransform somewhere() {
    return {quaternion_from({0.3f, -0.2f, 0.5f}), {0.05f, -0.1f, 0.08f}};
}

HeldTool blade() {
    return {0.1f, 0.0f, somewhere()};
}

void follow(HeldTool& tool, int steps, const Overtravel& overtravel = {}) {
    for (int i = 0; i < steps; ++i) {
        tool.advance(held_tool_dt, overtravel);
    }
}

TEST(HeldTool, FollowsStraightPathAtLimitedSpeed) {
    HeldTool tool = blade();
    const Vec3f from = tool.tip(), way(0.0f, 0.024f, 0.0f);
    tool.move(way);
    follow(tool, 18);  // 0.1 s at 0.12 m/s
    EXPECT_NEAR((tool.tip() - from - 0.012f * Vec3f::UnitY()).norm(), 0.0f, held_tool_tolerance);
    follow(tool, 30);
    EXPECT_NEAR((tool.tip() - from - way).norm(), 0.0f, held_tool_tolerance) << "and arrives";
}

TEST(HeldTool, LimitsDistanceOfRequestedPose) {
    HeldTool tool = blade();
    tool.move({1.0f, 0.0f, 0.0f});
    tool.advance(held_tool_dt, {});
    EXPECT_LE((tool.target().translation - somewhere().translation).norm(),
              HandLimits().max_target_distance + held_tool_tolerance);
}

TEST(HeldTool, TurningAndSwingingGripKeepsTipFixed) {
    HeldTool tool = blade();
    const Vec3f tip = tool.tip();
    tool.turn({0.2f, 0.1f, -0.3f});
    tool.swing_grip({0.01f, 0.02f, 0.0f});
    follow(tool, 200);
    EXPECT_NEAR((tool.tip() - tip).norm(), 0.0f, 2 * held_tool_tolerance);
    EXPECT_GT((tool.pose().translation - somewhere().translation).norm(), 5e-3f);
}

TEST(HeldTool, SmallSwingMovesGripWithMouse) {
    HeldTool tool = blade();
    // Across the tool: no rotation about its own axis moves the grip.
    const Vec3f across = somewhere().rotation * Vec3f(1e-3f, 0.5e-3f, 0.0f);
    tool.swing_grip(across);
    // An arc of 1.1 mm on a radius of 100 mm deviates from its tangent by 1.1^2 / 200 mm.
    EXPECT_NEAR((tool.target().translation - somewhere().translation - across).norm(), 6e-6f, 3e-6f);
}

TEST(HeldTool, SwingingTipKeepsPivotFixed) {
    HeldTool tool = blade();
    const Vec3f lips = tool.point_at(0.04f);
    tool.swing_tip(lips, {0.004f, 0.0f, 0.003f});
    EXPECT_NEAR((tool.point_at(0.04f) - lips).norm(), 0.0f, held_tool_tolerance);
}

TEST(HeldTool, CurvedTubeSlidesAlongItsArc) {
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
    EXPECT_NEAR(tube.arc_length_to(tip), length - 0.02f, 2 * held_tool_tolerance);
}

TEST(HeldTool, LiftsAlongTheHandle) {
    HeldTool tool = blade();
    tool.lift(0.009f);
    follow(tool, 60);
    EXPECT_NEAR((somewhere().inverse() * tool.pose().translation - Vec3f(0, 0.009f, 0)).norm(), 0.0f,
                held_tool_tolerance);
}

TEST(HeldTool, SlowsWithOvertravelAndStops) {
    const HandLimits limits;
    const Vec3f way(0.0f, 0.02f, 0.01f);
    const auto step = [&](float overtravel) {
        HeldTool tool = blade();
        tool.move(way);
        tool.advance(held_tool_dt, {{0.0f, overtravel, 0.0f}, Vec3f::Zero()});
        return Vec3f(tool.target().translation - tool.pose().translation +
                     (tool.pose().translation - somewhere().translation));
    };
    EXPECT_NEAR((step(0.5f * limits.max_overtravel) - way).norm(), 0.0f, held_tool_tolerance)
        << "half of it is free";
    EXPECT_NEAR(step(0.75f * limits.max_overtravel).y(), 0.5f * way.y(), held_tool_tolerance)
        << "then less and less";
    EXPECT_NEAR(step(limits.max_overtravel).y(), 0.0f, held_tool_tolerance) << "to nothing";
    EXPECT_NEAR(step(limits.max_overtravel).z(), way.z(), held_tool_tolerance) << "aside it goes on";
    EXPECT_NEAR(step(-limits.max_overtravel).y(), way.y(), held_tool_tolerance) << "and back";
}

TEST(HeldTool, RetractsImmediatelyAfterLongPush) {
    HeldTool tool = blade();
    const Overtravel wall{{0.0f, HandLimits().max_overtravel, 0.0f}, Vec3f::Zero()};
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

TEST(HeldTool, ExcessOvertravelDecaysExponentially) {
    const HandLimits limits;
    HeldTool tool = blade();
    // A wall that does not move: the overtravel is the hand's position minus the wall's.
    const float wall = somewhere().translation.y() - 0.01f;
    const int steps = static_cast<int>(std::round(limits.yield_time / held_tool_dt));
    for (int i = 0; i < steps; ++i) {
        tool.advance(held_tool_dt, {{0.0f, tool.pose().translation.y() - wall, 0.0f}, Vec3f::Zero()});
    }
    const float excess = tool.pose().translation.y() - wall - limits.max_overtravel;
    // Explicit steps of 1/27 of the time constant: (1 - 1/27)^27 instead of 1/e.
    EXPECT_NEAR(excess,
                (0.01f - limits.max_overtravel) * std::pow(1.0f - held_tool_dt / limits.yield_time, steps),
                2 * held_tool_tolerance);
}

TEST(HeldTool, IgnoresNonFiniteInput) {
    HeldTool tool = blade();
    tool.move({0.0f, 0.01f, 0.0f});
    tool.advance(held_tool_dt, {{NAN, 0.0f, 0.0f}, Vec3f::Zero()});
    tool.advance(NAN, {});
    EXPECT_EQ((tool.pose().translation - somewhere().translation).norm(), 0.0f);
}

}  // namespace
}  // namespace eti
