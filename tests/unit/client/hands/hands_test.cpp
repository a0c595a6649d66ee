// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/hands.hpp"

#include <gtest/gtest.h>

#include "client/app/window/command_keys.hpp"
#include "client/app/window/selection.hpp"
#include "client/app/window/vantage_controls.hpp"
#include "client/hands/picture_plane.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

using hands::Drag;
using hands::Hands;

constexpr float hands_dt = 1.0f / 180.0f, hands_height = 540.0f;
constexpr float hands_tolerance = 2e-6f;  // [m], rounding of floats of a metre

class HandsTest : public ::testing::Test {
  protected:
    void follow(int steps) {
        for (int i = 0; i < steps; ++i) {
            hands_.advance(hands_dt, {}, {});
        }
    }
    void drag(const Drag& mouse) { hands_.drag({mouse, camera_, hands_height}, scene_.landmarks); }
    [[nodiscard]] const HeldTool& blade() const { return hands_.held(Tool::laryngoscope); }
    [[nodiscard]] const HeldTool& tube() const { return hands_.held(Tool::tube); }

    synthetic::Scene scene_ = synthetic::make_scene();
    Laryngoscope scope_ = make_laryngoscope(Blade::miller_1);
    Tube tube_;
    Hands hands_{scope_, tube_, scene_.landmarks};
    render::Camera camera_ = [] {
        render::Camera out;
        out.eye = {0.4f, 0.0f, 0.05f};
        out.target = {0.0f, 0.0f, 0.0f};
        return out;
    }();
};

TEST_F(HandsTest, StartBeforeMouthPointingInwards) {
    const Vec3f& mouth = at(scene_.landmarks, Landmark::mouth_opening);
    for (const Tool tool : {Tool::laryngoscope, Tool::tube}) {
        const HeldTool& held = hands_.held(tool);
        const float away = (held.tip() - mouth).norm();
        EXPECT_GT(away, 0.02f);
        EXPECT_LT(away, 0.07f);
        // The hand is farther out than the tip, and the handle or the tube's hollow side is anterior.
        EXPECT_GT((held.pose().translation - mouth).norm(), away + 0.04f);
        const Vec3f ahead = held.tip() - held.point_at(held.length() - 5e-3f);
        EXPECT_GT(ahead.dot(at(scene_.landmarks, Landmark::glottis) - held.tip()), 0.0f)
            << "towards the throat";
        EXPECT_LT(ahead.z(), 0.0f);
        EXPECT_LT((held.pose().rotation * Vec3f::UnitY()).z(), 0.0f) << "the hollow side, the handle";
    }
}

TEST_F(HandsTest, OnlyActiveHandMoves) {
    const Vec3f blade_tip = blade().tip(), tube_tip = tube().tip();
    drag({.x = 30.0f});
    follow(100);
    EXPECT_GT((blade().tip() - blade_tip).norm(), 1e-3f);
    EXPECT_EQ((tube().tip() - tube_tip).norm(), 0.0f);
    const Vec3f moved = blade().tip();
    EXPECT_TRUE(hands_.press(hands::other_hand_key));
    drag({.x = 30.0f});
    follow(100);
    EXPECT_NEAR((blade().tip() - moved).norm(), 0.0f, hands_tolerance);
    EXPECT_GT((tube().tip() - tube_tip).norm(), 1e-3f);
}

TEST_F(HandsTest, TipFollowsPointer) {
    const Vec3f from = blade().tip();
    drag({.x = 20.0f, .y = -8.0f});
    follow(100);
    const Vec3f expected = hands::picture_displacement(camera_, hands_height, from, 20.0f, -8.0f);
    EXPECT_NEAR((blade().tip() - from - expected).norm(), 0.0f, hands_tolerance);
}

TEST_F(HandsTest, WheelSlidesToolAndRightButtonSwingsGrip) {
    const Vec3f from = blade().tip(), axis = blade().pose().rotation * Vec3f::UnitZ();
    drag({.notches = 3.0f});
    follow(100);
    EXPECT_NEAR((blade().tip() - from - 6e-3f * axis).norm(), 0.0f, hands_tolerance) << "2 mm a notch";
    const Vec3f tip = blade().tip(), grip = blade().pose().translation;
    drag({.y = 25.0f, .right_button = true});
    follow(100);
    EXPECT_NEAR((blade().tip() - tip).norm(), 0.0f, hands_tolerance);
    EXPECT_GT((blade().pose().translation - grip).norm(), 1e-3f);
}

TEST_F(HandsTest, KeysMoveToolWhileHeld) {
    const RigidTransform from = blade().pose();
    EXPECT_TRUE(hands_.press(U'w'));
    follow(90);  // half a second at 15 mm/s
    hands_.release(U'w');
    follow(90);
    EXPECT_NEAR((from.inverse() * blade().pose().translation - Vec3f(0, 7.5e-3f, 0)).norm(), 0.0f,
                hands_tolerance);
    EXPECT_TRUE(hands_.press(U'g'));
    follow(180);
    hands_.release(U'g');
    // About +x the tip goes down; 25 deg/s for a second.
    const Vec3f turned = rotation_vector(from.rotation.conjugate() * blade().pose().rotation);
    EXPECT_NEAR((turned + Vec3f(25.0f * degree, 0, 0)).norm(), 0.0f, 1e-4f);
    EXPECT_FALSE(hands_.press(U'?'));
}

TEST_F(HandsTest, TubeInMouthPivotsAboutLips) {
    (void)hands_.press(hands::other_hand_key);
    const Vec3f& mouth = at(scene_.landmarks, Landmark::mouth_opening);
    for (int i = 0; i < 40 && tube().arc_length_to(mouth) > 0.07f; ++i) {
        drag({.notches = 1.0f});
        follow(20);
    }
    const float outside = tube().arc_length_to(mouth);
    ASSERT_LT(outside, tube_.grip_from_tip - 5e-3f);
    const Vec3f lips = tube().point_at(outside);
    drag({.x = 15.0f});
    follow(100);
    EXPECT_NEAR((tube().point_at(outside) - lips).norm(), 0.0f, hands_tolerance);
}

TEST_F(HandsTest, HomeKeyReturnsToStart) {
    const RigidTransform start = blade().pose();
    drag({.x = 40.0f, .notches = 5.0f});
    follow(100);
    EXPECT_TRUE(hands_.press(home_key));
    follow(200);
    EXPECT_NEAR((blade().pose().translation - start.translation).norm(), 0.0f, hands_tolerance);
}

// A key with two meanings would perform only one of them.
TEST(HandKeys, DoNotCollideWithOtherKeys) {
    for (const HandKey& row : hand_keys()) {
        EXPECT_EQ(client::command_key(row.key), nullptr) << row.caption;
        EXPECT_EQ(client::vantage_key(row.key), nullptr) << row.caption;
        EXPECT_EQ(client::selection_for_key(static_cast<char>(row.key)), nullptr) << row.caption;
        EXPECT_TRUE(hands::is_hand_key(row.key));
    }
    EXPECT_EQ(client::command_key(home_key), nullptr);
    EXPECT_EQ(client::vantage_key(home_key), nullptr);
    EXPECT_FALSE(hands::is_hand_key(U'h'));
}

}  // namespace
}  // namespace eti
