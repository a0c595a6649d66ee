// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/operator/track_player.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/model/tools/tools.hpp"
#include "tests/unit/common/operator/playing.hpp"

namespace eti {
namespace {

// Single precision at 0.1 m, after a handful of products of rotations.
constexpr float rounding = 1e-6f;

TEST_F(Playing, PutsTheTipAtTheLandmarkAndTheAxisOnTheLine) {
    Stage stage = stage_at(Landmark::vallecula);
    stage.tip_offset = Vec3f(0.001f, 0.002f, 0.003f);
    stage.axis_from_offset = Vec3f(0, -0.004f, -0.005f);
    begin({stage});
    play(5);
    const Vec3f target = landmark(Landmark::vallecula) + stage.tip_offset;
    const Vec3f line = (target - landmark(Landmark::upper_gum) - stage.axis_from_offset).normalized();
    EXPECT_TRUE(player_->finished());
    EXPECT_LT((tip() - target).norm(), rounding);
    EXPECT_LT((along() - line).norm(), 1e-5f);
    // Of all directions across the axis, the tool's own left is the one nearest the patient's left; the
    // handle then points anterior.
    const Vec3f left(1, 0, 0);
    const Vec3f across = pose_.rotation * Vec3f::UnitX();
    EXPECT_NEAR(across.dot(line), 0, 1e-5f);
    EXPECT_LT((across - (left - left.dot(line) * line).normalized()).norm(), 1e-5f);
    EXPECT_LT(handle().y(), -0.5f);
    EXPECT_NEAR(pose_.rotation.toRotationMatrix().determinant(), 1, 1e-5f);
}

TEST_F(Playing, AxisMayPointAtAnotherLandmark) {
    Stage stage = stage_at(Landmark::mouth_opening);
    stage.axis_to_tip = false;
    stage.axis_to = Landmark::glottis;
    begin({stage});
    play(5);
    EXPECT_LT((tip() - landmark(Landmark::mouth_opening)).norm(), rounding);
    EXPECT_LT((along() - (landmark(Landmark::glottis) - landmark(Landmark::upper_gum)).normalized()).norm(),
              1e-5f);
}

TEST_F(Playing, StartsFortyMillimetresBeforeItsTarget) {
    begin({stage_at(Landmark::vallecula)});
    const Vec3f start = tip();
    play(5);
    EXPECT_LT((start + 0.04f * along() - tip()).norm(), rounding);
}

TEST_F(Playing, MovesWithMinimumJerkWithinItsSpeed) {
    Stage stage = stage_at(Landmark::vallecula);
    stage.speed = 0.03f;
    begin({stage});
    const Vec3f start = tip();
    const double duration = 1.875 * 0.04 / 0.03;  // Flash & Hogan 1985: peak = 15/8 of the mean
    float fastest = 0;
    Vec3f before = tip();
    while (!player_->finished() && seen_.time < 10) {
        step();
        const double u = std::min(1.0, seen_.time / duration);
        const auto share = static_cast<float>(u * u * u * (10 + u * (-15 + 6 * u)));
        ASSERT_NEAR((tip() - start).norm(), 0.04f * share, 2 * rounding) << "at " << seen_.time << " s";
        fastest = std::max(fastest, (tip() - before).norm() / static_cast<float>(dt));
        before = tip();
    }
    EXPECT_NEAR(seen_.time, duration, 2 * dt);
    // A speed from two positions over 1 ms carries twice their rounding, 1e-8 m each, over 1e-3 s.
    EXPECT_NEAR(fastest, 0.03f, 1e-4f);
}

TEST_F(Playing, NeverJumpsFromStageToStage) {
    Stage rocking = kept("rock");
    rocking.pitch = 0.3f;
    rocking.pivot_at_tip = false;
    Stage raise = kept("lift");
    raise.lift = 0.01f;
    begin({stage_at(Landmark::mouth_opening), stage_at(Landmark::tongue_dorsum),
           stage_at(Landmark::vallecula), rocking, raise, stage_at(Landmark::mouth_opening)});
    RigidTransform before = pose_;
    while (!player_->finished() && seen_.time < 60) {
        step();
        // 0.03 m/s of the tip, and at most 2 rad/s about it over the blade's length.
        ASSERT_LT((pose_.translation - before.translation).norm(),
                  (0.03f + 2.0f * length) * static_cast<float>(dt) * 1.01f);
        ASSERT_LT((pose_.rotation * before.rotation.conjugate()).vec().norm(),
                  static_cast<float>(dt) * 1.01f);
        before = pose_;
    }
    EXPECT_TRUE(player_->finished());
}

TEST_F(Playing, LiftsAlongTheHandleAndAdvancesAlongTheTool) {
    Stage move = kept("move");
    move.lift = 0.008f;
    move.advance = 0.005f;
    begin({stage_at(Landmark::vallecula), move});
    ASSERT_TRUE(play_until("move"));
    const Vec3f start = tip();
    play(5);
    EXPECT_LT((tip() - start - 0.008f * handle() - 0.005f * along()).norm(), 2 * rounding);
    EXPECT_LT(handle().y(), 0) << "lifting goes anteriorly";
}

TEST_F(Playing, PitchAndYawPivotAboutTheTip) {
    Stage pitched = kept("pitch");
    pitched.pitch = 0.2f;
    Stage yawed = kept("yaw");
    yawed.yaw = 0.1f;
    begin({stage_at(Landmark::vallecula), pitched, yawed});
    ASSERT_TRUE(play_until("pitch"));
    const Vec3f point = tip(), axis = along(), up = handle();
    ASSERT_TRUE(play_until("yaw"));
    EXPECT_LT((tip() - point).norm(), 2 * rounding);
    EXPECT_LT((along() - (std::cos(0.2f) * axis + std::sin(0.2f) * up)).norm(), 1e-5f);
    play(5);
    EXPECT_LT((tip() - point).norm(), 2 * rounding);
    EXPECT_NEAR(along().x(), std::sin(0.1f), 1e-5f);  // the patient's left is +x
}

TEST_F(Playing, RockingPivotsAboutTheGum) {
    Stage rocking = kept("rock");
    rocking.pitch = 0.35f;
    rocking.pivot_at_tip = false;
    rocking.pivot = Landmark::upper_gum;
    begin({stage_at(Landmark::vallecula), rocking});
    ASSERT_TRUE(play_until("rock"));
    const Vec3f gum = landmark(Landmark::upper_gum);
    const Vec3f on_blade = pose_.inverse() * gum;
    float turned = 0;
    const Vec3f axis = along();
    while (!player_->finished()) {
        step();
        ASSERT_LT((pose_ * on_blade - gum).norm(), 2 * rounding);
        turned = std::acos(std::min(1.0f, along().dot(axis)));
    }
    EXPECT_NEAR(turned, 0.35f, 1e-4f);
}

TEST_F(Playing, AimsOnceUnlessFollowing) {
    for (const bool follow : {false, true}) {
        Stage stage = stage_at(Landmark::vallecula);
        stage.follow = follow;
        stage.hold = 5;
        begin({stage});
        play(2);
        const Vec3f moved(0, -0.003f, 0.002f);
        const Vec3f aimed = landmark(Landmark::vallecula);
        seen_.landmarks[static_cast<std::size_t>(Landmark::vallecula)] += moved;
        play(3);
        // Following: a low pass of 0.1 s, after thirty time constants.
        EXPECT_LT((tip() - aimed - (follow ? moved : Vec3f(Vec3f::Zero()))).norm(), 2 * rounding);
    }
}

TEST_F(Playing, HoldsBeforeTheNextStage) {
    Stage stage = stage_at(Landmark::vallecula);
    stage.hold = 1.5f;
    begin({stage});
    while (!player_->finished() && seen_.time < 20) {
        step();
    }
    EXPECT_NEAR(seen_.time, 1.875 * 0.04 / 0.03 + 1.5, 2 * dt);
}

TEST_F(Playing, IgnoresTransientConditions) {
    Stage waiting = stage_at(Landmark::vallecula);
    waiting.until_view_percent = 50;
    waiting.timeout = 30;
    begin({waiting, kept("go")});
    play(4);
    for (int glimpse = 0; glimpse < 10; ++glimpse) {
        seen_.glottic_opening_percent = 80;
        play(0.9 * static_cast<double>(reaction));
        seen_.glottic_opening_percent = 10;
        play(0.01);
    }
    EXPECT_NE(player_->stage_name(), "go") << "glimpses add up";
    seen_.glottic_opening_percent = 50;
    const double saw = seen_.time;
    ASSERT_TRUE(play_until("go"));
    EXPECT_NEAR(seen_.time - saw, static_cast<double>(reaction), 3 * dt);
}

TEST_F(Playing, WaitsForAllConditions) {
    Stage waiting = stage_at(Landmark::vallecula);
    waiting.until_view_percent = 50;
    waiting.until_tube_depth = 0.02f;
    waiting.until_time = 9;
    waiting.timeout = 100;
    begin({waiting, kept("go")});
    play(4);
    seen_.glottic_opening_percent = 60;
    play(2);
    seen_.tube_depth_past_glottis = 0.021f;
    play(2);
    EXPECT_NE(player_->stage_name(), "go");
    ASSERT_TRUE(play_until("go"));
    EXPECT_NEAR(seen_.time, 9 + static_cast<double>(reaction), 3 * dt);
}

TEST_F(Playing, TimeoutContinuesOrAborts) {
    for (const bool abort : {false, true}) {
        Stage waiting = stage_at(Landmark::vallecula);
        waiting.until_view_percent = 50;
        waiting.timeout = 2;
        waiting.abort_on_timeout = abort;
        begin({waiting, kept("pass the tube"), kept("withdraw")});
        ASSERT_TRUE(play_until(abort ? "withdraw" : "pass the tube"));
        EXPECT_NEAR(seen_.time, 1.875 * 0.04 / 0.03 + 2, 3 * dt);
        EXPECT_EQ(player_->aborted(), abort);
    }
}

TEST_F(Playing, PushesTheTubeToItsDepthAtTheLip) {
    Stage stage = stage_at(Landmark::glottis);
    stage.depth_at_lip = 0.085f;
    begin({stage});
    play(10);
    EXPECT_NEAR(along().dot(tip() - landmark(Landmark::mouth_opening)), 0.085f, 2 * rounding);

    stage.depth_at_lip = -1;
    stage.depth_by_rule = true;
    seen_.tube_depth_rule = 0.071f;
    begin({stage});
    play(10);
    EXPECT_NEAR(along().dot(tip() - landmark(Landmark::mouth_opening)), 0.071f, 2 * rounding);

    seen_.tube_depth_rule = 0;  // not known yet: uses the landmark
    begin({stage});
    play(10);
    EXPECT_LT((tip() - landmark(Landmark::glottis)).norm(), rounding);
}

// A tube of 140 mm curve radius that is held 100 mm from its tip.
TEST_F(Playing, CurvedTubePassesMouthAndEndsAtTarget) {
    constexpr float radius = 0.14f;
    const RigidTransform to_tip{
        Quatf(Eigen::AngleAxisf(-length / radius, Vec3f::UnitX())),
        Vec3f(0, radius * (1 - std::cos(length / radius)), radius * std::sin(length / radius))};
    Stage in = stage_at(Landmark::glottis);
    in.axis_from_offset = Vec3f(0, 0, -0.006f);
    Stage further = kept("further");
    further.advance = 0.025f;
    player_.emplace(Track{{in, further}}, length, 0.0f, reaction, 1, 1 / radius);
    seen_.landmarks = newborn_landmarks();
    ASSERT_TRUE(play_until("further"));
    const Vec3f glottis = landmark(Landmark::glottis);
    const Vec3f through = landmark(Landmark::upper_gum) + in.axis_from_offset;
    EXPECT_LT((pose_ * to_tip.translation - glottis).norm(), 2 * rounding);
    // The arc's centre lies on the concave side, anterior of the chord, one radius from every point of the
    // tube.
    const Vec3f centre = pose_ * Vec3f(0, radius, 0);
    EXPECT_NEAR((through - centre).norm(), radius, 2 * rounding);
    EXPECT_LT(centre.y(), 0.5f * (through + glottis).y());
    // The end points more steeply into the trachea than the line from the mouth does.
    const auto steepness = [](const Vec3f& v) { return std::atan2(-v.z(), v.y()); };
    const Vec3f chord = glottis - through;
    EXPECT_NEAR(steepness(pose_.rotation * (to_tip.rotation * Vec3f::UnitZ())) - steepness(chord),
                std::asin(chord.norm() / 2 / radius), 1e-4f);
    // Pushed further, it slides along its own arc.
    play(5);
    EXPECT_LT((pose_ * Vec3f(0, radius, 0) - centre).norm(), 5 * rounding);
    EXPECT_NEAR((pose_ * to_tip.translation - glottis).norm(), 2 * radius * std::sin(0.0125f / radius),
                2 * rounding);
}

TEST_F(Playing, DepthAtTheLipIsMeasuredAlongTheCurve) {
    constexpr float radius = 0.14f;
    Stage stage = stage_at(Landmark::glottis);
    stage.depth_at_lip = 0.08f;
    player_.emplace(Track{{stage}}, length, 0.0f, reaction, 1, 1 / radius);
    seen_.landmarks = newborn_landmarks();
    play(10);
    // The mouth opening is abeam of the point 80 mm behind the tip, 20 mm from the grip.
    const float angle = 0.02f / radius;
    const RigidTransform there{Quatf(Eigen::AngleAxisf(-angle, Vec3f::UnitX())),
                               Vec3f(0, radius * (1 - std::cos(angle)), radius * std::sin(angle))};
    EXPECT_NEAR((there.inverse() * (pose_.inverse() * landmark(Landmark::mouth_opening))).z(), 0,
                5 * rounding);
}

TEST_F(Playing, SlightCurveHardlyMatters) {
    Stage stage = stage_at(Landmark::glottis);
    stage.advance = 0.02f;
    begin({stage});
    play(10);
    const RigidTransform straight = pose_;
    seen_.time = 0;
    player_.emplace(Track{{stage}}, length, 0.0f, reaction, 1, 1e-3f);
    play(10);
    // A radius of 1 km: 100 mm deviate by L^2 / 2R = 5e-6 m and turn by 1e-4 rad.
    EXPECT_LT((pose_.translation - straight.translation).norm(), 2e-5f);
}

// Lengths scale with the cube root of weight: a newborn of 3.5 kg / 8 is half as long as one of 3.5 kg.
TEST_F(Playing, LengthsScaleWithTheScriptsWeight) {
    Stage stage = stage_at(Landmark::vallecula);
    stage.tip_offset = Vec3f(0.001f, 0.002f, 0.003f);
    stage.tip_fixed_offset = Vec3f(0, 0.006f, 0);
    stage.axis_from_offset = Vec3f(0, -0.004f, -0.005f);
    stage.axis_from_fixed_offset = Vec3f(0, 0, -0.002f);
    Stage move = kept("move");
    move.lift = 0.008f;
    move.advance = 0.005f;
    move.until_tube_depth = 0.02f;
    move.timeout = 100;
    for (const auto& [weight, size] :
         {std::pair(3.5, 1.0f), std::pair(3.5 / 8, 0.5f), std::pair(0.0, 1.0f)}) {
        const Track track{{stage, move}, 3.5f};
        player_.emplace(track, length, 0.0f, reaction, 1);
        seen_ = {};
        seen_.landmarks = newborn_landmarks();
        seen_.tube_depth_rule = weight > 0.0 ? static_cast<float>(tube_depth_by_weight(weight)) : 0.0f;
        ASSERT_TRUE(play_until("move"));
        // 437.5 g are rounded to 438 g: 1 part in 2600 of the size.
        const float rounded = 4e-4f * 0.009f + 2 * rounding;
        const Vec3f target = landmark(Landmark::vallecula) + size * stage.tip_offset + stage.tip_fixed_offset;
        EXPECT_LT((tip() - target).norm(), rounded) << weight << " kg";
        const Vec3f line = target - landmark(Landmark::upper_gum) - size * stage.axis_from_offset -
                           stage.axis_from_fixed_offset;
        EXPECT_LT((along() - line.normalized()).norm(), 1e-4f) << weight << " kg";
        const Vec3f start = tip();
        play(5);
        EXPECT_LT((tip() - start - size * (0.008f * handle() + 0.005f * along())).norm(), rounded)
            << weight << " kg";
        seen_.tube_depth_past_glottis = 0.0199f * size;
        play(1);
        EXPECT_FALSE(player_->finished()) << weight << " kg";
        seen_.tube_depth_past_glottis = 0.0201f * size;
        play(1);
        EXPECT_TRUE(player_->finished()) << weight << " kg";
    }
}

TEST_F(Playing, StopsAtTheSeenDepth) {
    Stage push = kept("push");
    push.advance = 0.04f;
    push.until_tube_depth = 0.02f;
    begin({stage_at(Landmark::glottis), push, kept("hold")});
    ASSERT_TRUE(play_until("push"));
    const Vec3f start = tip();
    const auto depth = [&] { return (tip() - start).norm(); };
    for (int i = 0; i < 60'000 && player_->stage_name() != "hold"; ++i) {
        seen_.tube_depth_past_glottis = depth();
        step();
    }
    // Passed during the reaction time, at no more than 0.03 m/s.
    EXPECT_GE(depth(), 0.02f);
    EXPECT_LE(depth(), 0.02f + 0.03f * reaction + 1e-4f);
    const Vec3f stopped = tip();
    play(5);
    EXPECT_LT((tip() - stopped).norm(), 1e-4f) << "it goes on";
}

// A rim that the tip pushes ahead of itself, until it slips over the tip and stays.
TEST_F(Playing, FollowsLandmarkUntilBladeIsPastIt) {
    Stage pass = stage_at(Landmark::epiglottis_tip);
    pass.follow = true;
    pass.tip_offset = {0, 0, -30e-3f};
    pass.until_blade_past = 6e-3f;
    begin({stage_at(Landmark::tongue_dorsum), pass, kept("hold")});
    ASSERT_TRUE(play_until(pass.name));
    Vec3f& rim = seen_.landmarks[static_cast<std::size_t>(Landmark::epiglottis_tip)];
    const float slips = rim.z() - 4e-3f;
    const auto past = [&] { return length - (pose_.inverse() * rim).z(); };
    float fastest = 0.0f;  // [m/s]
    for (int i = 0; i < 60'000 && player_->stage_name() == pass.name; ++i) {
        seen_.proxy = pose_;
        rim.z() = std::clamp(tip().z(), slips, rim.z());
        rim.x() = 5e-3f;  // and it slides to the left
        const Vec3f before = tip();
        step();
        fastest = std::max(fastest, (tip() - before).norm() / static_cast<float>(dt));
    }
    EXPECT_EQ(player_->stage_name(), "hold");
    EXPECT_LE(rim.z(), slips + 1e-6f) << "the tip was never past it";
    // Passed during the reaction time.
    EXPECT_GE(past(), 6e-3f);
    EXPECT_LE(past(), 6e-3f + fastest * (reaction + 2.0f * static_cast<float>(dt)));
    EXPECT_LT(past(), 25e-3f) << "it goes on to what it aims at";
    EXPECT_GT(tip().x(), 2e-3f) << "it does not follow";
}

TEST_F(Playing, TimeoutEndsTheWaitForTheBlade) {
    Stage pass = stage_at(Landmark::epiglottis_tip);
    pass.until_blade_past = 6e-3f;
    pass.timeout = 0.5f;
    begin({pass, kept("hold")});
    for (int i = 0; i < 60'000 && player_->stage_name() != "hold"; ++i) {
        seen_.proxy = pose_;
        step();
    }
    EXPECT_EQ(player_->stage_name(), "hold");
    EXPECT_LT((tip() - landmark(Landmark::epiglottis_tip)).norm(), 1e-4f);
}

TEST_F(Playing, LiftsOnlyUntilTheViewSuffices) {
    Stage lift = kept("lift");
    lift.lift = 20e-3f;
    lift.until_view_percent = 50;
    begin({stage_at(Landmark::vallecula), lift, kept("hold")});
    ASSERT_TRUE(play_until("lift"));
    const Vec3f start = tip();
    const auto lifted = [&] { return (tip() - start).norm(); };
    for (int i = 0; i < 60'000 && !player_->finished(); ++i) {
        seen_.glottic_opening_percent = lifted() > 8e-3f ? 60.0f : 0.0f;
        step();
    }
    // At no more than 0.03 m/s during the reaction time.
    EXPECT_GE(lifted(), 8e-3f);
    EXPECT_LE(lifted(), 8e-3f + 0.03f * reaction + 1e-4f);
}

TEST_F(Playing, StaysFiniteBeforeLandmarksAreKnown) {
    player_.emplace(Track{{stage_at(Landmark::vallecula), kept("go")}}, length, 1e-4f, reaction, 1);
    for (int i = 0; i < 5000; ++i) {
        step();
        ASSERT_TRUE(pose_.translation.allFinite() && pose_.rotation.coeffs().allFinite());
        ASSERT_NEAR(pose_.rotation.norm(), 1, 1e-5f);
    }
}

TEST_F(Playing, EmptyTrackStaysClearOfThePatient) {
    player_.emplace(Track{}, length, 0.0f, reaction, 1);
    seen_.landmarks = newborn_landmarks();
    step();
    EXPECT_TRUE(player_->finished());
    for (const Vec3f& point : seen_.landmarks) {
        EXPECT_GT((pose_.translation - point).norm(), 0.2f);
    }
}

}  // namespace
}  // namespace eti
