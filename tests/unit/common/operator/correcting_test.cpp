// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/common/operator/playing.hpp"

namespace eti {
namespace {

// A blade that is displaced from the hand's goal [m].
class Leaning : public Playing {
  protected:
    void press(const Vec3f& pushed_off, double seconds) {
        Track track{{stage_at(Landmark::vallecula)}};
        track.lean = 5e-3f;
        track.stages[0].hold = 60;
        player_.emplace(track, length, 0.0f, reaction, 1);
        seen_ = {};
        seen_.landmarks = newborn_landmarks();
        pose_ = player_->wanted(seen_);
        for (int i = 0; i < static_cast<int>(seconds / dt); ++i) {
            seen_.proxy = {pose_.rotation, pose_.translation + pushed_off};
            step();
        }
    }

    // [m], along the tool's own left, and across it.
    [[nodiscard]] float leaning() const { return left().dot(tip() - landmark(Landmark::vallecula)); }
    [[nodiscard]] float elsewhere() const {
        const Vec3f off = tip() - landmark(Landmark::vallecula);
        return (off - left() * left().dot(off)).norm();
    }
    [[nodiscard]] Vec3f left() const { return pose_.rotation * Vec3f::UnitX(); }
};

TEST_F(Leaning, ReturnsTheTipToItsTarget) {
    press({3e-3f, 0, 0}, 5);
    EXPECT_NEAR(leaning(), -3e-3f, 1e-4f);
    EXPECT_LT(elsewhere(), 1e-5f);
}

TEST_F(Leaning, IsBounded) {
    press({-12e-3f, 0, 0}, 10);
    EXPECT_NEAR(leaning(), 5e-3f, 1e-5f);
}

TEST_F(Leaning, IsCompliantInOtherDirections) {
    press({0, 4e-3f, 6e-3f}, 5);
    EXPECT_LT(std::abs(leaning()) + elsewhere(), 1e-4f);
}

TEST_F(Leaning, IgnoresBladeFarFromTheHand) {
    press({30e-3f, 0, 0}, 5);
    EXPECT_LT(std::abs(leaning()), 1e-5f);
}

// A curved tube whose tip is displaced from the hand's aim.
class Steering : public Playing {
  protected:
    static constexpr float bend = 1 / 0.07f;  // [1/m]

    void begin_tube(const Vec3f& held_off, float until_aside = -1.0f) {
        Stage aim = stage_at(Landmark::glottis);
        aim.steer = true;
        aim.hold = 60;
        if (until_aside > 0.0f) {
            aim.until_tube_aside = until_aside;
            aim.hold = 0;
            aim.timeout = 60;
        }
        player_.emplace(Track{{aim, kept("hold")}}, length, 0.0f, reaction, 1, bend);
        seen_ = {};
        seen_.landmarks = newborn_landmarks();
        held_off_ = held_off;
        look();
    }

    void look() {
        pose_ = player_->wanted(seen_);
        seen_.tube_tip = tube_tip() + held_off_;
    }

    void play_tube(double seconds) {
        for (int i = 0; i < static_cast<int>(seconds / dt); ++i) {
            seen_.time += dt;
            look();
        }
    }

    [[nodiscard]] RigidTransform along_tube(float s) const {
        return pose_ * RigidTransform{Quatf(Eigen::AngleAxisf(-bend * s, Vec3f::UnitX())),
                                      Vec3f(0, (1 - std::cos(bend * s)) / bend, std::sin(bend * s) / bend)};
    }
    [[nodiscard]] Vec3f tube_tip() const { return along_tube(length).translation; }

    // [m], of the visible tip from the line through the glottis into the trachea.
    [[nodiscard]] float aside() const {
        const Vec3f& glottis = landmark(Landmark::glottis);
        const Vec3f line = (landmark(Landmark::trachea_mid) - glottis).normalized();
        return (seen_.tube_tip - glottis).cross(line).norm();
    }

    // [m], of the tube from a point.
    [[nodiscard]] float from_tube(const Vec3f& point) const {
        float least = 1;
        for (int i = 0; i <= 1000; ++i) {
            least = std::min(least,
                             (along_tube(1e-3f * static_cast<float>(i) * length).translation - point).norm());
        }
        return least;
    }

    Vec3f held_off_ = Vec3f::Zero();
};

TEST_F(Steering, BringsSeenTipOntoTheTrachealAxis) {
    for (const Vec3f& held_off : {Vec3f(3e-3f, 0, 0), Vec3f(0, 3e-3f, 0), Vec3f(-2e-3f, -2e-3f, 1e-3f)}) {
        begin_tube(held_off);
        play_tube(8);
        EXPECT_LT(aside(), 2e-4f) << held_off.transpose();
    }
}

// By a factor of e each 0.3 s, like a hand that integrates the visible error.
TEST_F(Steering, CorrectsTheErrorAtItsRate) {
    begin_tube(Vec3f::Zero());
    play_tube(10);
    held_off_ = Vec3f(3e-3f, 0, 0);
    look();
    const float before = aside();
    EXPECT_NEAR(before, 3e-3f, 1e-4f);
    play_tube(0.3);
    EXPECT_NEAR(aside() / before, std::exp(-1.0f), 0.05f);
}

TEST_F(Steering, PivotsTheTubeAtTheLips) {
    begin_tube(Vec3f::Zero());
    play_tube(8);
    const float straight = from_tube(landmark(Landmark::mouth_opening));
    begin_tube({3e-3f, 2e-3f, 0});
    play_tube(8);
    EXPECT_NEAR(from_tube(landmark(Landmark::mouth_opening)), straight, 5e-4f);
}

TEST_F(Steering, AdvancesOnlyOnceTheTipIsAligned) {
    begin_tube({30e-3f, 0, 0}, 5e-4f);  // more than steering compensates
    play_tube(20);
    EXPECT_FALSE(player_->finished());
    EXPECT_GT(aside(), 20e-3f);
    begin_tube({3e-3f, 0, 0}, 5e-4f);
    play_tube(20);
    EXPECT_TRUE(player_->finished());
    EXPECT_LT(aside(), 5e-4f);
}

TEST_F(Steering, IsBounded) {
    begin_tube({14e-3f, 0, 0});
    play_tube(20);
    EXPECT_NEAR(aside(), 14e-3f - 8e-3f, 1e-3f);
}

// The accumulated correction decays while the tip moves to the lips, about which it turns: no faster than a
// quick hand.
TEST_F(Steering, LimitsTubeSpeedDuringWithdrawal) {
    Stage aim = stage_at(Landmark::glottis);
    aim.steer = true;
    aim.hold = 12;
    Stage out = kept("out");
    out.withdraw = 30e-3f;
    out.speed = 0.05f;
    for (const Vec3f& held_off : {Vec3f(14e-3f, 0, 0), Vec3f(0, 14e-3f, 0), Vec3f(-9e-3f, -9e-3f, 0)}) {
        player_.emplace(Track{{aim, out}}, length, 0.0f, reaction, 1, bend);
        seen_ = {};
        seen_.landmarks = newborn_landmarks();
        held_off_ = held_off;
        look();
        float fastest = 0.0f;
        while (!player_->finished() && seen_.time < 60) {
            const Vec3f before = pose_.translation;
            seen_.time += dt;
            look();
            fastest = std::max(fastest, (pose_.translation - before).norm() / static_cast<float>(dt));
        }
        EXPECT_TRUE(player_->finished());
        EXPECT_LT(fastest, 1.0f) << held_off.transpose();
    }
}

TEST_F(Steering, StopsCorrectingPastTheCords) {
    begin_tube({3e-3f, 0, 0});
    seen_.tube_depth_past_glottis = 1e-3f;
    play_tube(8);
    EXPECT_GT(aside(), 2.5e-3f);
}

}  // namespace
}  // namespace eti
