// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/scene.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>

#include "common/math/units.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/coarse_newborn.hpp"
#include "tests/support/newborn_scene.hpp"
#include "tests/support/threads.hpp"

namespace eti::scene {
namespace {

class SceneTest : public ::testing::Test {
  protected:
    SceneTest() {
        static const Vec3f tongue = at(make().snapshot().landmarks, Landmark::tongue_dorsum);
        tongue_ = tongue;
    }

    [[nodiscard]] Scene make(const Settings& settings = {}) const {
        return {test::coarse_newborn(), scope_, Tube{}, away_, settings};
    }

    /// The blade in the mouth, its tip over the tongue's highest point, and `depth` [m] lower.
    [[nodiscard]] Inputs pressing(float depth) const {
        Inputs inputs = away_;
        inputs.laryngoscope = test::blade_with_tip_at(tongue_ + Vec3f(0.0f, 0.0f, 6e-3f - depth), scope_);
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
    Inputs away_ = test::parked_tools(20.0f, 25.0f);
    Vec3f tongue_ = Vec3f::Zero();
};

// A manikin has no simulated tissue: nothing stops a tool or is displaced by it anywhere.
TEST_F(SceneTest, ManikinToolsFollowDevicesExactly) {
    Settings settings;
    settings.manikin = true;
    Scene scene = make(settings);
    const Snapshot before = scene.snapshot();
    Inputs inputs = away_;
    for (int k = 0; k < 40; ++k) {
        inputs = pressing(0.5e-3f * static_cast<float>(k));
        inputs.tube_grip.translation = tongue_ + Vec3f(0.0f, -0.05f, 1e-3f * static_cast<float>(k));
        scene.step(inputs);
        const Snapshot& s = scene.snapshot();
        ASSERT_EQ(s.proxy.translation, inputs.laryngoscope.translation);
        ASSERT_EQ(s.proxy.rotation.coeffs(), inputs.laryngoscope.rotation.coeffs());
        ASSERT_TRUE(s.shell_contacts.empty());
        ASSERT_TRUE(s.tissue_contacts.empty());
        ASSERT_EQ(s.tissue_force, Vec3f(Vec3f::Zero()));
        ASSERT_EQ(s.shell_force, Vec3f(Vec3f::Zero()));
        // The tube on its arc: the position of its tip follows from the grip and the arc's radius.
        const Tube tube;
        const Vec3f tip =
            (inputs.tube_grip * along_arc(1.0f / tube.curve_radius, tube.grip_from_tip)).translation;
        // The rod's segments are chords of the arc: with sixteen of them its end deviates by less than a
        // tenth of a mm.
        ASSERT_LT((s.tube_nodes.back() - tip).norm(), 1e-4f);
    }
    EXPECT_EQ(scene.snapshot().step, 40u);
    for (std::size_t i = 0; i < before.frames.size(); ++i) {
        ASSERT_EQ(scene.snapshot().frames[i].centre, before.frames[i].centre) << "frame " << i;
    }
}

TEST_F(SceneTest, UntouchedTissueStaysAtRest) {
    Scene scene = make();
    const std::vector<FramePose> before = scene.snapshot().frames;
    test::hold(scene, away_, 60);
    for (std::size_t i = 0; i < before.size(); ++i) {
        ASSERT_LT((scene.snapshot().frames[i].centre - before[i].centre).norm(), 2e-6f) << "frame " << i;
    }
    EXPECT_EQ(scene.snapshot().tissue_force, Vec3f(Vec3f::Zero()));
    EXPECT_EQ(scene.snapshot().shell_force, Vec3f(Vec3f::Zero()));
}

TEST_F(SceneTest, ImplicitTongueIsSteadyUnderBlade) {
    const auto pressed = [&] {
        auto scene =
            std::make_unique<Scene>(test::coarse_newborn(), scope_, Tube{}, away_, Settings{.rigid = {}});
        press(*scene);
        for (int k = 0; k < 240; ++k) {
            scene->step(pressing(std::min(6e-3f + 0.15e-3f * static_cast<float>(k), 12e-3f)));
        }
        return scene;
    };
    const auto pressed_scene = pressed();
    const Scene& scene = *pressed_scene;
    const Snapshot& s = scene.snapshot();
    EXPECT_GT(s.tissue_force.norm(), 0.1f);
    Vec3f sum = Vec3f::Zero();
    for (const TissueContact& c : s.tissue_contacts) {
        sum += c.force;
    }
    EXPECT_LT((sum - s.tissue_force).norm(), 1e-4f * s.tissue_force.norm());
    // A third of the speed of a hand's tremor of 0.1 mm at 10 Hz (6 mm/s), the least that is felt.
    double squared = 0.0;
    std::size_t count = 0;
    const pbd::Particles& p = scene.tissue().body().particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (scene.tissue().tongue().moves(i)) {
            squared += static_cast<double>(p.velocity[i].squaredNorm());
            ++count;
        }
    }
    ASSERT_GT(count, 100u);
    EXPECT_LT(std::sqrt(squared / static_cast<double>(count)), 2e-3);
    for (const std::size_t threads : {1, 8}) {
        EXPECT_EQ(test::with_threads(threads, [&] { return pressed()->state_hash(); }), scene.state_hash());
    }
}

// The reference is the same scene with other substeps: at rest the force is the material's.
TEST_F(SceneTest, ImplicitTongueForceIsSubstepIndependent) {
    const auto force_with = [&](int substeps) {
        Scene scene = make({.substeps = substeps, .rigid = {}});
        press(scene);
        for (int k = 0; k < 240; ++k) {
            scene.step(pressing(std::min(6e-3f + 0.15e-3f * static_cast<float>(k), 12e-3f)));
        }
        return scene.snapshot().tissue_force.norm();
    };
    const float usual = force_with(8);
    EXPECT_GT(usual, 0.1f);
    EXPECT_NEAR(force_with(4), usual, 0.03f * usual);
    EXPECT_NEAR(force_with(16), usual, 0.03f * usual);
}

TEST_F(SceneTest, StiffImplicitTongueIsStableUnderFastBlade) {
    Inputs stiff = away_;
    stiff.runtime_parameters.tissue_stiffness = 100e3f;
    Scene scene = make();
    scene.reset(stiff);
    EXPECT_FLOAT_EQ(scene.snapshot().runtime_parameters.tissue_stiffness, 100e3f);
    const auto pressed = [&](float depth) {
        Inputs inputs = pressing(depth);
        inputs.runtime_parameters.tissue_stiffness = 100e3f;
        return inputs;
    };
    scene.place_laryngoscope(pressed(0.0f).laryngoscope);
    // Half a metre a second: 2.8 mm in a step, during which the tongue is solved four times.
    float depth = 0.0f;
    for (; depth < 12e-3f; depth += 0.5f / steps_per_second) {
        scene.step(pressed(depth));
        ASSERT_TRUE(scene.snapshot().tissue_force.allFinite());
    }
    // Bones give way for a second, so that the force falls; it must not oscillate meanwhile.
    float before = 0.0f;
    for (int k = 0; k < 240; ++k) {
        scene.step(pressed(depth));
        const float force = scene.snapshot().tissue_force.norm();
        if (k >= 120) {
            EXPECT_NEAR(force, before, 0.01f * force) << k;
        }
        before = force;
    }
    EXPECT_GT(before, 1.0f);
}

TEST_F(SceneTest, SelfContactLeavesRestShapeUnchanged) {
    Scene scene = make({.rigid = {}, .self_contact = true});
    test::hold(scene, away_, 60);
    const pbd::Particles& p = scene.tissue().body().particles;
    for (std::size_t i = 0; i < p.size(); ++i) {
        ASSERT_LT((p.position[i] - p.rest[i]).norm(), 2e-6f) << "particle " << i;
    }
    press(scene);
    EXPECT_GT(scene.snapshot().tissue_force.z(), 0.01f);
}

// The reference is the same scene with sleep: contact must not depend on it.
TEST_F(SceneTest, SelfContactIsIndependentOfSleeping) {
    const auto pressed = [&](bool self_contact, bool sleep) {
        Scene scene = make({.rigid = {}, .self_contact = self_contact, .sleep = sleep});
        press(scene);
        return scene.tissue().body().particles.position;
    };
    const auto farthest = [](const std::vector<Vec3f>& from, const std::vector<Vec3f>& to) {
        float most = 0.0f;
        for (std::size_t i = 0; i < from.size(); ++i) {
            most = std::max(most, (to[i] - from[i]).norm());
        }
        return most;
    };
    const std::vector<Vec3f> meets = pressed(true, false);
    const float sleeps_through = pbd::Sleep::Settings{}.shift;
    EXPECT_GT(farthest(pressed(false, false), meets), 50.0f * sleeps_through);
    // What sleeps stands off by up to `shift`; a contact that this makes or breaks moves few particles by
    // more.
    const std::vector<Vec3f> asleep = pressed(true, true);
    std::size_t apart = 0;
    for (std::size_t i = 0; i < meets.size(); ++i) {
        apart += (asleep[i] - meets[i]).norm() > sleeps_through ? 1 : 0;
    }
    EXPECT_LT(apart, meets.size() / 40);
    EXPECT_LT(farthest(asleep, meets), 25.0f * sleeps_through);
}

TEST_F(SceneTest, TimeIsStepsOverTheRate) {
    Scene scene = make();
    test::hold(scene, away_, steps_per_second);
    EXPECT_EQ(scene.snapshot().step, 180u);
    EXPECT_EQ(scene.snapshot().time_ns, 1'000'000'000u);
}

TEST_F(SceneTest, ResetReproducesTheRun) {
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

TEST_F(SceneTest, SameBitsForAnyNumberOfThreads) {
    const auto run = [&](std::size_t threads) {
        return test::with_threads(threads, [&] {
            Scene scene = make();
            press(scene);
            return scene.state_hash();
        });
    };
    const std::uint64_t one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(8), one);
}

TEST_F(SceneTest, ProxyIsReportedBeforeTissueMoves) {
    Scene scene = make();
    press(scene);
    const Inputs deeper = pressing(0.15e-3f * 41.0f);
    const auto& position = scene.tissue().body().particles.position;
    const std::vector<Vec3f> before(position.begin(), position.end());
    ProxySnapshot passed;
    scene.step(deeper, [&](const ProxySnapshot& proxy) {
        passed = proxy;
        EXPECT_TRUE(std::ranges::equal(position, before));
    });
    EXPECT_FALSE(std::ranges::equal(position, before));
    const Snapshot& after = scene.snapshot();
    EXPECT_EQ(passed.step, after.step);
    EXPECT_EQ(passed.time_ns, after.time_ns);
    EXPECT_EQ(passed.device.translation, deeper.laryngoscope.translation);
    EXPECT_EQ(passed.proxy.translation, after.proxy.translation);
    EXPECT_EQ(passed.shell_force, after.shell_force);
    EXPECT_EQ(passed.shell_contacts.size(), after.shell_contacts.size());

    Scene untold = make();
    press(untold);
    untold.step(deeper);
    EXPECT_EQ(untold.state_hash(), scene.state_hash());
}

TEST_F(SceneTest, BladeAndTonguePressOnEachOther) {
    Scene scene = make();
    press(scene);
    EXPECT_LT(at(scene.snapshot().landmarks, Landmark::tongue_dorsum).z(), tongue_.z() - 0.5e-3f);
    EXPECT_GT(scene.snapshot().tissue_force.z(), 0.01f) << "up, against the blade's motion";
    // After the blade is lifted off, the tissue returns to its position.
    test::hold(scene, away_, 2 * steps_per_second);
    EXPECT_NEAR(at(scene.snapshot().landmarks, Landmark::tongue_dorsum).z(), tongue_.z(), 0.1e-3f);
    EXPECT_EQ(scene.snapshot().tissue_force, Vec3f(Vec3f::Zero()));
}

TEST_F(SceneTest, SettledStepDoesNotAllocate) {
    // One thread: oneTBB allocates its own tasks from pools that grow with the threads it starts.
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    const std::array<Settings, 3> all = {{{.rigid = {}},
                                          {.rigid = {}, .self_contact = true},
                                          {.tissue_method = TissueMethod::clusters, .rigid = {}}}};
    for (std::size_t n = 0; n < all.size(); ++n) {
        Scene scene = make(all[n]);
        press(scene);
        ASSERT_FALSE(scene.snapshot().tissue_contacts.empty());
        const Inputs held = pressing(0.15e-3f * 39.0f);
        scene.step(held);
        const long before = test::allocations();
        for (int k = 0; k < 20; ++k) {
            scene.step(held);
        }
        EXPECT_EQ(test::allocations(), before) << n;
    }
}

TEST_F(SceneTest, PostureRateIsLimited) {
    Scene scene = make();
    Inputs inputs = away_;
    inputs.runtime_parameters.head_elevation = 40.0f * degree;  // beyond the joint
    scene.step(inputs);
    EXPECT_NEAR(scene.snapshot().runtime_parameters.head_elevation, 20.0f * degree + 0.17f * step_duration,
                1e-6f);
    test::hold(scene, inputs, 3 * steps_per_second);
    EXPECT_FLOAT_EQ(scene.snapshot().runtime_parameters.head_elevation, max_head_elevation);
}

/// The mean height of the tongue's fifty highest particles [m].
float tongue_height(const Scene& scene) {
    const pbd::Particles& p = scene.tissue().body().particles;
    std::vector<float> z;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (scene.tissue().tissue_of(i) == Tissue::tongue) {
            z.push_back(p.position[i].z());
        }
    }
    std::ranges::sort(z, std::greater());
    return std::accumulate(z.begin(), z.begin() + 50, 0.0f) / 50.0f;
}

// Rotated by half a turn, implicit tetrahedra end in a knot (docs/solver/stability.md): all have positive
// volume, but are wound about each other. With the tools away the tongue recovers.
class TurnedTongue {
  public:
    TurnedTongue(Scene& scene, const Vec3f& about) : scene_(scene) {
        auto& p = const_cast<pbd::Particles&>(scene.tissue().body().particles);  // NOLINT: as a hand might
        const Quatf half_a_turn(Eigen::AngleAxisf(180.0f * degree, Vec3f::UnitZ()));
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (scene.tissue().tongue().moves(i)) {
                p.position[i] = about + half_a_turn * (p.position[i] - about);
                p.velocity[i].setZero();
            }
        }
    }

    [[nodiscard]] bool awake() const { return scene_.tissue().body().sleep.mesh_awake(); }
    /// Largest distance of its particles from rest [m].
    [[nodiscard]] float farthest() const {
        const pbd::Particles& p = scene_.tissue().body().particles;
        float most = 0.0f;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (scene_.tissue().tongue().moves(i)) {
                most = std::max(most, (p.position[i] - p.rest[i]).norm());
            }
        }
        return most;
    }

  private:
    Scene& scene_;
};

TEST_F(SceneTest, TangledTongueRecovers) {
    Scene scene = make();
    press(scene);
    scene.place_laryngoscope(away_.laryngoscope);
    const TurnedTongue tongue(scene, tongue_);
    EXPECT_GT(tongue.farthest(), 10e-3f);
    test::hold(scene, away_, 4 * steps_per_second);
    EXPECT_LT(tongue.farthest(), 0.01e-3f);
}

TEST_F(SceneTest, TangledSleepingTongueWakesWhenBladeLeaves) {
    Scene scene = make();
    press(scene);
    const Inputs above = pressing(-12e-3f);
    scene.place_laryngoscope(above.laryngoscope);
    for (int k = 0; k < 10 * steps_per_second && scene.tissue().body().sleep.mesh_awake(); ++k) {
        scene.step(above);
    }
    const TurnedTongue tongue(scene, tongue_);
    ASSERT_FALSE(tongue.awake());
    scene.step(above);
    EXPECT_GT(tongue.farthest(), 1e-3f) << "nothing draws it while a blade is near";
    test::hold(scene, away_, 4 * steps_per_second);
    EXPECT_LT(tongue.farthest(), 0.1e-3f);
}

TEST_F(SceneTest, ChangedStiffnessMatchesInitialStiffness) {
    const float usual = test::coarse_newborn().tissue_stiffness;
    const auto settled = [&](float first, float later) {
        Inputs start = away_;
        start.runtime_parameters.tissue_stiffness = first;
        Scene scene(test::coarse_newborn(), scope_, Tube{}, start, {});
        press(scene);
        Inputs held = pressing(0.15e-3f * 39.0f);
        held.runtime_parameters.tissue_stiffness = later;
        float before = scene.snapshot().tissue_force.norm();
        float largest = 0.0f;
        for (int k = 0; k < 3 * steps_per_second; ++k) {
            scene.step(held);
            const float now = scene.snapshot().tissue_force.norm();
            largest = std::max(largest, std::fabs(now - before));
            before = now;
        }
        return std::array{before, largest};
    };
    const auto [soft, soft_change] = settled(usual, usual);
    const auto [stiff, stiff_change] = settled(12e3f, 12e3f);
    const auto [late, late_change] = settled(usual, 12e3f);
    ASSERT_GT(stiff, 1.2f * soft);
    // The path there leaves friction on the blade at other points: no more than a twentieth.
    EXPECT_NEAR(late, stiff, 0.05f * stiff);
    // A step changes the stiffness by 1/180, and the force with it; other motion, as the tissue settles with
    // the blade held, also occurs in the other runs.
    EXPECT_LT(late_change, std::max(soft_change, stiff_change) + 2.0f * stiff / steps_per_second);
}

// A larger one would touch the palate, whose friction holds it a tenth of a millimetre off. The tube's
// runtime parameters converge to the pose of a tube built with them from the start.
TEST_F(SceneTest, ChangedTubeMatchesTubeBuiltThatWay) {
    Inputs wanted = away_;
    wanted.tube_grip.rotation = Quatf(Eigen::AngleAxisf(90.0f * degree, Vec3f::UnitX()));
    Inputs soft = wanted;
    soft.runtime_parameters.tube_youngs_modulus = 2e6f;
    soft.runtime_parameters.tube_curve_radius = 2.0f;
    const auto tip_after = [](Scene& scene, const Inputs& inputs, int steps) {
        test::hold(scene, inputs, steps);
        return scene.snapshot().tube_nodes.back();
    };
    Scene changed(test::coarse_newborn(), scope_, Tube{}, wanted, Settings{});
    const Vec3f before = tip_after(changed, wanted, 180);
    // By a factor of e a second: 3.5 s to straight, and two to come to rest.
    const Vec3f after = tip_after(changed, soft, 180 * 6);
    Scene made(test::coarse_newborn(), scope_, Tube{}, soft, Settings{});
    const Vec3f expected = tip_after(made, soft, 180 * 2);
    EXPECT_GT((after - before).norm(), 5e-3f);
    EXPECT_LT((after - expected).norm(), 0.05f * (after - before).norm());
}

TEST_F(SceneTest, TongueSwellsSmoothlyAndShrinksBack) {
    Scene scene = make();
    const float before = tongue_height(scene);
    const std::vector<FramePose> frames = scene.snapshot().frames;
    const auto grow = [&](float scale, int steps) {
        Inputs inputs = away_;
        inputs.runtime_parameters.tongue_scale = scale;
        float last = tongue_height(scene);
        float fastest = 0.0f;
        for (int k = 0; k < steps; ++k) {
            scene.step(inputs);
            fastest = std::max(fastest, std::fabs(tongue_height(scene) - last));
            last = tongue_height(scene);
        }
        return fastest;
    };
    const float fastest = grow(1.1f, 4 * steps_per_second);
    EXPECT_FLOAT_EQ(scene.snapshot().runtime_parameters.tongue_scale, 1.1f);
    const float grown = tongue_height(scene) - before;
    EXPECT_GT(grown, 1e-3f);
    // A tenth per second of 20 mm at most, in one step; twice that where it eases in.
    EXPECT_LT(fastest, 2.0f * 0.1f * 20e-3f / steps_per_second);
    EXPECT_EQ(scene.snapshot().tissue_force, Vec3f(Vec3f::Zero()));
    (void)grow(1.0f, 5 * steps_per_second);
    EXPECT_NEAR(tongue_height(scene), before, 2e-5f);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        ASSERT_LT((scene.snapshot().frames[i].centre - frames[i].centre).norm(), 1e-4f) << "frame " << i;
    }
}

TEST_F(SceneTest, ResetAppliesTongueSizeImmediately) {
    Inputs large = away_;
    large.runtime_parameters.tongue_scale = 1.1f;
    Scene swollen = make();
    for (int k = 0; k < 5 * steps_per_second; ++k) {
        swollen.step(large);
    }
    Scene reset = make();
    reset.reset(large);
    EXPECT_FLOAT_EQ(reset.snapshot().runtime_parameters.tongue_scale, 1.1f);
    for (int k = 0; k < 2 * steps_per_second; ++k) {
        reset.step(large);
    }
    EXPECT_NEAR(tongue_height(reset), tongue_height(swollen), 1e-4f);
}

TEST_F(SceneTest, HeadGrowthDoesNotAffectSimulation) {
    Scene usual = make();
    Scene large = make({.head_scale = 0.9f, .rigid = {}});
    Inputs inputs = away_;
    Inputs grow = away_;
    grow.runtime_parameters.head_scale = 0.9f;
    large.reset(grow);
    grow.runtime_parameters.head_scale = 1.08f;  // a fifth more
    const std::size_t first = patient::bone_count + test::coarse_newborn().clusters.size();
    const std::vector<FramePose> before = large.snapshot().frames;
    ASSERT_EQ(before.size(), first + patient::head_frame_count);
    for (int k = 0; k < 3 * steps_per_second; ++k) {
        usual.step(inputs);
        large.step(grow);
        ASSERT_LE(large.snapshot().runtime_parameters.head_scale,
                  0.9f + 0.1001f * static_cast<float>(k + 1) * step_duration);
    }
    EXPECT_FLOAT_EQ(large.snapshot().runtime_parameters.head_scale, 1.08f);
    EXPECT_EQ(large.state_hash(), usual.state_hash());
    for (std::size_t f = 0; f < before.size(); ++f) {
        const FramePose& now = large.snapshot().frames[f];
        const float way = f < first ? 0.0f : 0.2f * test::coarse_newborn().frame_rest_centre[f].norm();
        ASSERT_TRUE(f < first || way > 5e-3f);
        EXPECT_NEAR((now.centre - usual.snapshot().frames[f].centre).norm(), way, 1e-6f) << "frame " << f;
    }
    Scene reset = make({.head_scale = 0.9f, .rigid = {}});
    reset.reset(grow);
    EXPECT_FLOAT_EQ(reset.snapshot().runtime_parameters.head_scale, 1.08f);
}

TEST_F(SceneTest, TongueGrowthHasSameBitsForAnyThreads) {
    const auto run = [&](std::size_t threads) {
        return test::with_threads(threads, [&] {
            Scene scene = make();
            Inputs inputs = away_;
            inputs.runtime_parameters.tongue_scale = 1.1f;
            inputs.runtime_parameters.tissue_stiffness = 10e3f;
            inputs.runtime_parameters.table_angle = 0.1f;
            test::hold(scene, inputs, 150);
            return scene.state_hash();
        });
    };
    EXPECT_EQ(run(4), run(1));
}

TEST_F(SceneTest, TiltedTableOnlyRotatesGravity) {
    // Bones that yield would move a little with the tongue's weight.
    Scene level = make({.rigid = {}, .bones_yield = false});
    Scene tilted = make({.rigid = {}, .bones_yield = false});
    Inputs inputs = away_;
    inputs.runtime_parameters.table_angle = 0.5f;  // beyond its range
    const std::vector<FramePose> before = tilted.snapshot().frames;
    test::hold(tilted, inputs, 4 * steps_per_second);
    EXPECT_FLOAT_EQ(tilted.snapshot().runtime_parameters.table_angle, max_table_angle);
    for (std::size_t b = 0; b < patient::bone_count; ++b) {
        EXPECT_EQ(tilted.snapshot().frames[b].centre, before[b].centre);
    }
    // Head-up, the tongue sags towards the feet: by rho g sin(20 deg) L / E of its length of some 30 mm at
    // most.
    const Vec3f sag = at(tilted.snapshot().landmarks, Landmark::tongue_dorsum) -
                      at(level.snapshot().landmarks, Landmark::tongue_dorsum);
    EXPECT_LT(sag.z(), -5e-6f);
    EXPECT_GT(sag.z(), -1000.0f * 9.81f * 0.342f * 0.03f / 8e3f * 0.03f);
    inputs.runtime_parameters.table_angle = 0.0f;
    test::hold(tilted, inputs, 5 * steps_per_second);
    EXPECT_LT((at(tilted.snapshot().landmarks, Landmark::tongue_dorsum) -
               at(level.snapshot().landmarks, Landmark::tongue_dorsum))
                  .norm(),
              5e-6f);
}

TEST(Gravity, IsExactOnLevelTable) {
    const Vec3f level = patient::gravity(0.0f);
    EXPECT_EQ(level, Vec3f(0.0f, 9.81f, 0.0f));
    EXPECT_FALSE(std::signbit(level.z()));
    const Vec3f head_up = patient::gravity(30.0f * degree);
    EXPECT_NEAR(head_up.z(), -4.905f, 1e-5f) << "towards the feet";
    EXPECT_NEAR(head_up.norm(), 9.81f, 1e-5f);
}

}  // namespace
}  // namespace eti::scene
