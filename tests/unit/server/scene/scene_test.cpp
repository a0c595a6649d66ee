// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/scene.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "common/math/units.hpp"
#include "server/anatomy/build.hpp"
#include "tests/support/allocations.hpp"

namespace eti::scene {
namespace {

/// The built-in newborn, coarse enough to build in a second.
const anatomy::Patient& coarse_newborn() {
    static const anatomy::Patient patient =
        anatomy::build_patient({}, {.spacing = 3.5e-3f, .fine_spacing = 2e-3f, .surface_spacing = 2.5e-3f});
    return patient;
}

class SceneTest : public ::testing::Test {
  protected:
    SceneTest() {
        away_.laryngoscope.translation = Vec3f(0.0f, -0.25f, 0.15f);
        away_.tube_grip.translation = Vec3f(-0.12f, -0.25f, 0.10f);
        away_.posture = {20.0f * degree, 25.0f * degree};
        tongue_ = at(make().snapshot().landmarks, Landmark::tongue_dorsum);
    }

    [[nodiscard]] Scene make(const Settings& settings = {}) const {
        return {coarse_newborn(), scope_, Tube{}, away_, settings};
    }

    /// The blade in the mouth, its tip over the tongue where that is highest, and `depth` [m] lower.
    [[nodiscard]] Inputs pressing(float depth) const {
        Inputs inputs = away_;
        const Quatf turn(Eigen::AngleAxisf(-90.0f * degree, Vec3f::UnitX()));  // points posterior
        const Vec3f tip = tongue_ + Vec3f(0.0f, 0.0f, 6e-3f - depth);
        inputs.laryngoscope = {turn, tip - turn * scope_.tip()};
        return inputs;
    }

    /// Lowers the blade by 6 mm.
    void press(Scene& scene) const {
        scene.place_laryngoscope(pressing(0.0f).laryngoscope);
        for (int k = 0; k < 40; ++k) {
            scene.step(pressing(0.15e-3f * static_cast<float>(k)));
        }
    }

    Laryngoscope scope_ = make_laryngoscope(Blade::miller_1);
    Inputs away_;
    Vec3f tongue_ = Vec3f::Zero();
};

TEST_F(SceneTest, WhatNobodyTouchesStaysWhereItIs) {
    Scene scene = make();
    const std::vector<FramePose> before = scene.snapshot().frames;
    for (int k = 0; k < 60; ++k) {
        scene.step(away_);
    }
    for (std::size_t i = 0; i < before.size(); ++i) {
        ASSERT_LT((scene.snapshot().frames[i].centre - before[i].centre).norm(), 2e-6f) << "frame " << i;
    }
    EXPECT_EQ(scene.snapshot().tissue_force, Vec3f(Vec3f::Zero()));
    EXPECT_EQ(scene.snapshot().shell_force, Vec3f(Vec3f::Zero()));
}

TEST_F(SceneTest, TissueThatMeetsTissueIsLeftAloneAtRestAndStillGivesWay) {
    Scene scene = make({.rigid = {}, .self_contact = true});
    for (int k = 0; k < 60; ++k) {
        scene.step(away_);
    }
    const pbd::Particles& p = scene.tissue().body().particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        ASSERT_LT((p.position[i] - p.rest[i]).norm(), 2e-6f) << "particle " << i;
    }
    press(scene);
    EXPECT_GT(scene.snapshot().tissue_force.z(), 0.01f);
}

TEST_F(SceneTest, TimeIsStepsOverTheRate) {
    Scene scene = make();
    for (int k = 0; k < steps_per_second; ++k) {
        scene.step(away_);
    }
    EXPECT_EQ(scene.snapshot().step, 180u);
    EXPECT_EQ(scene.snapshot().time_ns, 1'000'000'000u);
}

TEST_F(SceneTest, ResetStartsTheSameCourseAgain) {
    Scene scene = make();
    const auto run = [&] {
        press(scene);
        return scene.state_hash();
    };
    const std::uint64_t first = run();
    scene.reset(away_);
    EXPECT_NE(scene.state_hash(), first);
    EXPECT_EQ(run(), first);
}

TEST_F(SceneTest, ThreadsDoNotChangeABit) {
    const auto run = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        Scene scene = make();
        press(scene);
        return scene.state_hash();
    };
    const std::uint64_t one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(8), one);
}

TEST_F(SceneTest, TheBladePressesTheTongueAndTheTonguePressesBack) {
    Scene scene = make();
    press(scene);
    EXPECT_LT(at(scene.snapshot().landmarks, Landmark::tongue_dorsum).z(), tongue_.z() - 0.5e-3f);
    EXPECT_GT(scene.snapshot().tissue_force.z(), 0.01f) << "up, against the blade's motion";
    // Lifted off again, the tissue comes back to where it was.
    for (int k = 0; k < 2 * steps_per_second; ++k) {
        scene.step(away_);
    }
    EXPECT_NEAR(at(scene.snapshot().landmarks, Landmark::tongue_dorsum).z(), tongue_.z(), 0.1e-3f);
    EXPECT_EQ(scene.snapshot().tissue_force, Vec3f(Vec3f::Zero()));
}

TEST_F(SceneTest, ASettledStepDoesNotAllocate) {
    // One thread: oneTBB's own tasks come from its pools, which grow with the threads it starts.
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    for (const bool self_contact : {false, true}) {
        Scene scene = make({.rigid = {}, .self_contact = self_contact});
        press(scene);
        ASSERT_FALSE(scene.snapshot().tissue_contacts.empty());
        const Inputs held = pressing(0.15e-3f * 39.0f);
        scene.step(held);
        const long before = test::allocations();
        for (int k = 0; k < 20; ++k) {
            scene.step(held);
        }
        EXPECT_EQ(test::allocations(), before) << self_contact;
    }
}

TEST_F(SceneTest, PostureIsApproachedAtANursesPace) {
    Scene scene = make();
    Inputs inputs = away_;
    inputs.posture.head_elevation = 40.0f * degree;  // beyond the joint
    scene.step(inputs);
    EXPECT_NEAR(scene.snapshot().head_elevation, 20.0f * degree + 0.17f * step_duration, 1e-6f);
    for (int k = 0; k < 3 * steps_per_second; ++k) {
        scene.step(inputs);
    }
    EXPECT_FLOAT_EQ(scene.snapshot().head_elevation, anatomy::max_head_elevation);
}

}  // namespace
}  // namespace eti::scene
