// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Sleeping tissue in the scene; for how groups fall asleep and wake see
// tests/unit/server/pbd/soft/sleep_test.cpp.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/coarse_newborn.hpp"
#include "tests/support/newborn_scene.hpp"
#include "tests/support/threads.hpp"

namespace eti::scene {
namespace {

class SceneSleepTest : public ::testing::TestWithParam<TissueMethod> {
  protected:
    [[nodiscard]] Scene make(bool sleeps = true, bool bones_yield = true) const {
        return {
            test::coarse_newborn(), scope_, Tube{}, away_,
            Settings{.tissue_method = GetParam(), .rigid = {}, .bones_yield = bones_yield, .sleep = sleeps}};
    }

    [[nodiscard]] static const pbd::Sleep& sleep_of(const Scene& scene) {
        return scene.tissue().body().sleep;
    }

    void rest(Scene& scene) const {
        test::hold(scene, away_, 20);
        ASSERT_EQ(sleep_of(scene).awake_groups(), 0u);
    }

    /// The blade in the mouth, its tip `depth` [m] below the tongue's back.
    [[nodiscard]] Inputs pressing(float depth) const {
        static const Vec3f tongue = at(make().snapshot().landmarks, Landmark::tongue_dorsum);
        Inputs inputs = away_;
        inputs.laryngoscope = test::blade_with_tip_at(tongue - Vec3f(0.0f, 0.0f, depth), scope_);
        return inputs;
    }

    Laryngoscope scope_ = make_laryngoscope(Blade::miller_1);
    Inputs away_ = test::parked_tools(20.0f, 25.0f);
};

TEST_P(SceneSleepTest, RestingStepSolvesNoTissue) {
    Scene scene = make();
    rest(scene);
    EXPECT_GT(sleep_of(scene).groups(), 10u);
    scene.step(away_);
    EXPECT_TRUE(scene.tissue().body().particles.awake.empty());
    EXPECT_FALSE(sleep_of(scene).any_awake());
    Scene awake = make(false);
    test::hold(awake, away_, 21);
    EXPECT_EQ(sleep_of(awake).awake_groups(), 0u) << "there are no groups at all";
    EXPECT_TRUE(sleep_of(awake).any_awake());
    EXPECT_EQ(awake.tissue().body().particles.awake.size(), 1u);
    for (std::size_t f = 0; f < awake.snapshot().frames.size(); ++f) {
        ASSERT_LT((scene.snapshot().frames[f].centre - awake.snapshot().frames[f].centre).norm(), 0.5e-6f)
            << f;
    }
}

TEST_P(SceneSleepTest, GlobalChangesWakeAllTissue) {
    const std::array<std::function<void(Inputs&)>, 4> changes = {
        [](Inputs& i) { i.runtime_parameters.head_elevation += 0.01f; },
        [](Inputs& i) { i.runtime_parameters.jaw_opening += 0.01f; },
        [](Inputs& i) { i.runtime_parameters.table_angle += 0.01f; },
        [](Inputs& i) { i.runtime_parameters.tissue_stiffness = 7.9e3f; },
    };
    Scene scene = make();
    for (std::size_t c = 0; c < changes.size(); ++c) {
        scene.reset(away_);
        EXPECT_TRUE(sleep_of(scene).all_awake()) << "a reset does, too";
        rest(scene);
        Inputs inputs = away_;
        changes[c](inputs);
        scene.step(inputs);
        EXPECT_TRUE(sleep_of(scene).all_awake()) << c;
        EXPECT_EQ(sleep_of(scene).awake_groups(), sleep_of(scene).groups()) << c;
    }
}

TEST_P(SceneSleepTest, UpdatedShellDistancesWakeTissue) {
    Scene scene = make();
    Inputs inputs = away_;
    // Nearly incompressible tissue settles more slowly, and must be asleep when the distances arrive.
    const float turn = GetParam() == TissueMethod::implicit ? 0.02f : 0.5f;
    inputs.runtime_parameters.head_elevation += turn * degree;
    std::size_t slept_at = 0;
    std::size_t woke_at = 0;
    for (std::size_t k = 1; k < 2 * PosedShell::grid_delay; ++k) {
        scene.step(inputs);
        slept_at = slept_at == 0 && sleep_of(scene).awake_groups() == 0 ? k : slept_at;
        woke_at = slept_at > 0 && woke_at == 0 && sleep_of(scene).all_awake() ? k : woke_at;
    }
    EXPECT_GT(slept_at, 9u);
    EXPECT_EQ(woke_at, static_cast<std::size_t>(PosedShell::grid_delay))
        << "from the first step on which bones moved";
}

TEST_P(SceneSleepTest, TurnedHeadMatchesNeverSleepingScene) {
    Scene scene = make();
    Scene awake = make(false);
    rest(scene);
    Inputs inputs = away_;
    inputs.runtime_parameters.head_elevation += 3.0f * degree;
    for (int k = 0; k < 3 * steps_per_second; ++k) {
        scene.step(inputs);
        awake.step(inputs);
    }
    EXPECT_EQ(sleep_of(scene).awake_groups(), 0u);
    const pbd::Particles& p = scene.tissue().body().particles;
    const pbd::Particles& q = awake.tissue().body().particles;
    double squares = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        squares += static_cast<double>((p.position[i] - q.position[i]).squaredNorm());
    }
    // Tissue that creeps by less than `still` in nine steps is stopped: if it comes to rest with a time
    // constant of a fifth of a second (36 steps), that is at most 2 um before its equilibrium.
    EXPECT_LT(std::sqrt(squares / static_cast<double>(p.size())), 2e-6);
}

// Bones on which the blade presses would keep all tissue awake.
TEST_P(SceneSleepTest, BladeForceIsIndependentOfSleeping) {
    Scene scene = make(true, false);
    Scene awake = make(false, false);
    for (Scene* s : {&scene, &awake}) {
        s->place_laryngoscope(pressing(-8e-3f).laryngoscope);
        for (int k = 0; k < 20; ++k) {
            s->step(pressing(-8e-3f));
        }
    }
    EXPECT_FALSE(sleep_of(scene).all_awake());
    float sum = 0.0f;
    float difference = 0.0f;
    for (int k = 0; k < 60; ++k) {
        const Inputs inputs = pressing(-8e-3f + 0.2e-3f * static_cast<float>(k));
        scene.step(inputs);
        awake.step(inputs);
        sum += awake.snapshot().tissue_force.norm();
        difference += (scene.snapshot().tissue_force - awake.snapshot().tissue_force).norm();
    }
    EXPECT_GT(sum / 60.0f, 0.01f);
    EXPECT_LT(difference, 5e-3f * sum) << "half a per cent";
}

TEST_P(SceneSleepTest, TubeWakesTissueBeforeContact) {
    Scene scene = make();
    rest(scene);
    const std::vector<Vec3f> before = scene.tissue().body().particles.position;
    const Vec3f tongue = at(scene.snapshot().landmarks, Landmark::tongue_dorsum);
    const Vec3f way = tongue - scene.snapshot().tube_nodes.back();
    Inputs inputs = away_;
    int steps = 0;
    while (sleep_of(scene).awake_groups() == 0 && steps < 500) {
        ++steps;
        inputs.tube_grip.translation = away_.tube_grip.translation + static_cast<float>(steps) / 500.0f * way;
        scene.step(inputs);
    }
    EXPECT_GT(steps, 50);
    EXPECT_LT(steps, 500);
    const std::vector<Vec3f>& after = scene.tissue().body().particles.position;
    for (std::size_t i = 0; i < before.size(); ++i) {
        ASSERT_LT((after[i] - before[i]).norm(), 0.5e-6f) << i;
    }
    scene.place_tube(away_.tube_grip);
    EXPECT_TRUE(sleep_of(scene).all_awake()) << "what it may have pressed on";
}

TEST_P(SceneSleepTest, SameBitsForAnyNumberOfThreads) {
    const auto run = [&](std::size_t threads) {
        return test::with_threads(threads, [&] {
            Scene scene = make(true, false);
            scene.place_laryngoscope(pressing(-8e-3f).laryngoscope);
            for (int k = 0; k < 15; ++k) {
                scene.step(pressing(-8e-3f));
            }
            bool half = false;
            for (int k = 0; k < 60; ++k) {
                scene.step(pressing(-8e-3f + 0.25e-3f * static_cast<float>(k)));
                half = half || (sleep_of(scene).awake_groups() > 0 && !sleep_of(scene).all_awake());
            }
            EXPECT_TRUE(half) << "some slept while others moved";
            return scene.state_hash();
        });
    };
    const std::uint64_t one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(8), one);
}

INSTANTIATE_TEST_SUITE_P(Models, SceneSleepTest,
                         ::testing::Values(TissueMethod::clusters, TissueMethod::implicit));

}  // namespace
}  // namespace eti::scene
