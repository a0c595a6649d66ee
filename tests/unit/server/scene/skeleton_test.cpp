// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Head, mandible and hyoid that yield: their mechanics against closed forms, the walls that go with them, and
// the whole scene.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "common/math/random.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/coarse_newborn.hpp"
#include "tests/support/newborn_scene.hpp"
#include "tests/support/threads.hpp"

namespace eti::scene {
namespace {

using Coordinates = YieldingSkeleton::Vector;
using Carrier = YieldingSkeleton::Carrier;

constexpr Carrier on_trunk{{1.0f, 0.0f, 0.0f}, 0.0f};
constexpr Carrier on_skull{{0.0f, 1.0f, 0.0f}, 0.0f};
constexpr Carrier on_mandible{{0.0f, 0.0f, 1.0f}, 0.0f};

/// A skeleton without tissue.
struct BareSkeleton {
    const patient::Patient& patient = test::coarse_newborn();
    JointProperties at_term;
    float size = std::cbrt(test::coarse_newborn().weight / 3.5f);
    YieldingSkeleton skeleton;

    explicit BareSkeleton(const JointProperties& properties = {})
        : at_term(properties), skeleton(test::coarse_newborn(), properties) {}

    void step(float dt) {
        pbd::YieldingBodies bodies;
        skeleton.write(bodies, dt);
        skeleton.advance(bodies.matrix.ldlt().solve(bodies.force), dt);
    }
    /// Until it rests under a force [N] on a point [m] that moves with the bones.
    void settle(const Vec3f& rest, const Carrier& carrier, const Vec3f& force) {
        for (int k = 0; k < 4000; ++k) {
            skeleton.unload();
            skeleton.add_load(skeleton.columns(rest, carrier), force);
            step(step_duration);
        }
    }
    [[nodiscard]] float offset(YieldingSkeleton::Coordinate c) const { return skeleton.offset()[c]; }
    [[nodiscard]] float gape() const {
        return (skeleton.pose_point(rest_of(patient, Landmark::lower_gum), on_mandible) -
                skeleton.pose_point(rest_of(patient, Landmark::upper_gum), on_skull))
            .norm();
    }
};

TEST(YieldingSkeleton, JacobianIsTheDerivativeOfThePose) {
    BareSkeleton bare;
    bare.skeleton.reset({20.0f * degree, 15.0f * degree, 0.0f});
    Coordinates away;
    away << 0.1f, 2e-3f, 0.05f, 3e-3f, 1e-3f, -2e-3f, 1.5e-3f;
    bare.skeleton.advance(away, 1.0f);
    Random random(3);
    for (int n = 0; n < 20; ++n) {
        const auto share = [&] { return random.uniform(); };
        Carrier carrier{{share(), share(), share()}, 0.5f * share()};
        const float sum = carrier.bones[0] + carrier.bones[1] + carrier.bones[2];
        for (float& weight : carrier.bones) {
            weight /= sum;
        }
        const Vec3f rest(0.04f * share() - 0.02f, 0.05f * share(), 0.08f * share() - 0.05f);
        const pbd::YieldingBodies::Columns columns = bare.skeleton.columns(rest, carrier);
        for (int c = 0; c < Coordinates::SizeAtCompileTime; ++c) {
            constexpr float h = 1e-2f;
            YieldingSkeleton ahead = bare.skeleton;
            YieldingSkeleton behind = bare.skeleton;
            ahead.advance(h * Coordinates::Unit(c), 1.0f);
            behind.advance(-h * Coordinates::Unit(c), 1.0f);
            const Vec3f slope =
                (ahead.pose_point(rest, carrier) - behind.pose_point(rest, carrier)) / (2.0f * h);
            // A central difference over 0.01 rad is off by 2e-5 of the arm.
            EXPECT_LT((slope - columns[static_cast<std::size_t>(c)].head<3>()).norm(), 1e-4f)
                << "coordinate " << c;
        }
    }
}

TEST(YieldingSkeleton, JawYieldsByForceOverStiffness) {
    BareSkeleton bare;
    const Vec3f chin = rest_of(bare.patient, Landmark::lower_gum);
    // Along the line through the joint the force only slides the jaw forwards.
    const Vec3f joint = bare.patient.skeleton.jaw_joint;
    const Vec3f at_joint(0.0f, chin.y(), joint.z());
    bare.settle(at_joint, on_mandible, {0.0f, -3.0f, 0.0f});
    const float slide = bare.at_term.jaw_slide * bare.size;
    EXPECT_NEAR(bare.offset(YieldingSkeleton::jaw_slide), 3.0f / slide, 0.02f * 3.0f / slide);
    // A force of 0.3 N across its arm opens it by torque over stiffness.
    BareSkeleton opened;
    opened.settle(chin, on_mandible, {0.0f, 0.0f, -0.3f});
    const float torsion = opened.at_term.jaw_opening * std::pow(opened.size, 3.0f);
    const float torque = opened.skeleton.load()[YieldingSkeleton::jaw_opening];
    EXPECT_NEAR(torque, 0.3f * (joint.y() - chin.y()), 0.1f * torque);
    EXPECT_NEAR(opened.offset(YieldingSkeleton::jaw_opening), torque / torsion, 1e-3f * torque / torsion);
}

// Neonates open by 22.0 mm (20.4-23.6 mm) under slight finger pressure; no force opens them much wider.
TEST(YieldingSkeleton, MouthOpensToThePublishedGape) {
    const Vec3f lower = rest_of(test::coarse_newborn(), Landmark::lower_gum);
    const Vec3f upper = rest_of(test::coarse_newborn(), Landmark::upper_gum);
    for (const float force : {2.5f, 5.0f, 20.0f}) {
        BareSkeleton bare;
        for (int k = 0; k < 4000; ++k) {
            const YieldingSkeleton& skeleton = bare.skeleton;
            const Vec3f apart =
                force * bare.size *
                (skeleton.pose_point(lower, on_mandible) - skeleton.pose_point(upper, on_skull)).normalized();
            bare.skeleton.unload();
            bare.skeleton.add_load(skeleton.columns(lower, on_mandible), apart);
            bare.skeleton.add_load(skeleton.columns(upper, on_skull), -apart);
            bare.step(step_duration);
        }
        EXPECT_GT(bare.gape(), 20.4e-3f * bare.size) << force << " N";
        EXPECT_LT(bare.gape(), 25.5e-3f * bare.size) << force << " N";
    }
}

TEST(YieldingSkeleton, HeadLeavesTheTableUnderMoreThanItsWeight) {
    const auto pulled = [](float share_of_weight) {
        BareSkeleton bare;
        const float weight = 9.81f * bare.at_term.head_mass * std::pow(bare.size, 3.0f);
        const Vec3f above_occiput =
            bare.patient.skeleton.neck_joint + Vec3f(0.0f, 0.0f, bare.size * bare.at_term.occiput);
        bare.settle(above_occiput, on_trunk, Vec3f::Zero());
        for (int k = 0; k < 20000; ++k) {
            bare.skeleton.unload();
            bare.skeleton.add_load(bare.skeleton.columns_at(above_occiput, on_skull),
                                   {0.0f, -share_of_weight * weight, 0.0f});
            bare.step(step_duration);
        }
        return std::pair(bare.offset(YieldingSkeleton::head_lift), weight);
    };
    const BareSkeleton bare;
    const auto [held, weight] = pulled(0.8f);
    EXPECT_LT(held, weight / bare.at_term.mattress);
    const auto [lifted, same] = pulled(1.2f);
    const float expected = 0.2f * weight / (bare.at_term.neck_lift * bare.size);
    EXPECT_NEAR(lifted, expected, 0.02f * expected);
}

TEST(YieldingSkeleton, MuscleToneScalesPassiveStiffness) {
    const Vec3f chin = rest_of(test::coarse_newborn(), Landmark::lower_gum);
    for (const float tone : {0.0f, 0.5f, 1.0f}) {
        BareSkeleton bare;
        const float stiffer = 1.0f + tone * (bare.at_term.awake - 1.0f);
        bare.skeleton.set_muscle_tone(tone);
        bare.settle(chin, on_mandible, {0.0f, 0.0f, -0.3f});
        const float torsion = stiffer * bare.at_term.jaw_opening * std::pow(bare.size, 3.0f);
        const float angle = bare.skeleton.load()[YieldingSkeleton::jaw_opening] / torsion;
        EXPECT_NEAR(bare.offset(YieldingSkeleton::jaw_opening), angle, 1e-3f * angle) << "tone " << tone;

        BareSkeleton hyoid;
        hyoid.skeleton.set_muscle_tone(tone);
        hyoid.settle(chin, {{1.0f, 0.0f, 0.0f}, 1.0f}, {0.4f, 0.0f, 0.5f});
        const float aside = 0.4f / (stiffer * hyoid.at_term.hyoid_sideways * hyoid.size);
        const float up = 0.5f / (stiffer * hyoid.at_term.hyoid_forward * hyoid.size);
        EXPECT_NEAR(hyoid.offset(YieldingSkeleton::hyoid_left), aside, 1e-3f * aside) << "tone " << tone;
        EXPECT_NEAR(hyoid.offset(YieldingSkeleton::hyoid_up), up, 1e-3f * up) << "tone " << tone;

        // Neck and mattress in parallel against a pull on the neck's joint.
        BareSkeleton neck;
        neck.skeleton.set_muscle_tone(tone);
        neck.settle(neck.patient.skeleton.neck_joint, on_skull, {0.0f, -2.0f, 0.0f});
        const float lift = neck.offset(YieldingSkeleton::head_lift);
        const float extension = neck.offset(YieldingSkeleton::head_extension);
        const float mattress = neck.at_term.mattress * (lift - neck.size * neck.at_term.occiput * extension);
        EXPECT_NEAR(stiffer * neck.at_term.neck_lift * neck.size * lift + mattress, 2.0f, 0.02f);
        EXPECT_NEAR(stiffer * neck.at_term.neck_extension * std::pow(neck.size, 3.0f) * extension,
                    neck.size * neck.at_term.occiput * mattress,
                    0.02f * neck.size * neck.at_term.occiput * mattress);
    }
}

TEST(YieldingSkeleton, HandHoldsTheJawByItsStiffness) {
    const Vec3f chin = rest_of(test::coarse_newborn(), Landmark::lower_gum);
    for (const float hand : {0.0f, 1.0f, 4.0f}) {
        JointProperties joints;
        joints.hand_on_jaw = hand;
        BareSkeleton bare(joints);
        bare.skeleton.reset({0.0f, 10.0f * degree, 0.0f});
        bare.settle(chin, on_mandible, {0.0f, 0.0f, -0.2f});
        const float torsion = hand + joints.jaw_opening * std::pow(bare.size, 3.0f);
        const float angle = bare.skeleton.load()[YieldingSkeleton::jaw_opening] / torsion;
        EXPECT_NEAR(bare.offset(YieldingSkeleton::jaw_opening), angle, 1e-3f * angle) << hand;
    }
}

TEST(YieldingSkeleton, LarynxYieldsByPressureOverStiffness) {
    BareSkeleton bare;
    const auto press = [&](const Vec3f& force) {
        for (int k = 0; k < 4000; ++k) {
            bare.skeleton.unload();
            bare.skeleton.press_larynx(force);
            bare.step(step_duration);
        }
    };
    press({-1.0f, 1.5f, 0.5f});
    const float sagittal = bare.at_term.hyoid_forward * bare.size;
    const float sideways = bare.at_term.hyoid_sideways * bare.size;
    EXPECT_NEAR(bare.offset(YieldingSkeleton::hyoid_left), -1.0f / sideways, 0.02f / sideways);
    EXPECT_NEAR(bare.offset(YieldingSkeleton::hyoid_back), 1.5f / sagittal, 0.02f * 1.5f / sagittal);
    EXPECT_NEAR(bare.offset(YieldingSkeleton::hyoid_up), 0.5f / sagittal, 0.02f * 0.5f / sagittal);
    EXPECT_LT(bare.skeleton.offset().head<4>().cwiseAbs().maxCoeff(), 1e-6f) << "head and jaw stay";
    press(Vec3f::Zero());
    EXPECT_LT(bare.skeleton.offset().cwiseAbs().maxCoeff(), 1e-6f);
}

// A spring k with a relaxing share s creeps under a constant force from F/k to F/(k (1 - s)), with the
// retardation time T / (1 - s).
TEST(YieldingSkeleton, MusclesCreepAsAStandardLinearSolid) {
    constexpr float share = 0.5f;
    constexpr float time = 1.0f;  // [s]
    BareSkeleton bare;
    bare.skeleton.relax({.share = share, .time = time});
    const float at_once = 1.0f / (bare.at_term.hyoid_sideways * bare.size);
    const float retardation = time / (1.0f - share);
    const auto pushed = [&](float seconds) {
        for (int k = 0; k < static_cast<int>(seconds * steps_per_second); ++k) {
            bare.skeleton.unload();
            bare.skeleton.press_larynx(Vec3f::UnitX());
            bare.step(step_duration);
        }
        return bare.offset(YieldingSkeleton::hyoid_left);
    };
    // The damper, of a tenth of a second, delays each value.
    EXPECT_NEAR(pushed(2.0f), at_once * (2.0f - std::exp(-2.0f / retardation)), 0.08f * at_once);
    EXPECT_NEAR(pushed(18.0f), 2.0f * at_once, 1e-3f * at_once);
    EXPECT_LT(bare.skeleton.unrelaxed().cwiseAbs().maxCoeff(), 1e-6f);
    bare.skeleton.unload();
    bare.skeleton.set_recovering(true);
    for (int k = 0; k < 2 * steps_per_second; ++k) {
        bare.step(step_duration);
    }
    EXPECT_LT(std::abs(bare.offset(YieldingSkeleton::hyoid_left)), 1e-6f) << "forgets at once";
}

TEST(YieldingSkeleton, SwingsAtItsNaturalFrequency) {
    JointProperties undamped;
    undamped.damping_time = 0.0f;
    undamped.jaw_slide_stop = 0.0f;
    BareSkeleton bare(undamped);
    const float stiffness = undamped.jaw_slide * bare.size;
    const float mass = undamped.jaw_mass * std::pow(bare.size, 3.0f);
    constexpr float dt = 2e-6f;
    bare.skeleton.advance(1e-3f * Coordinates::Unit(YieldingSkeleton::jaw_slide), 1e9f);
    float time = 0.0f;
    while (bare.offset(YieldingSkeleton::jaw_slide) > 0.0f && time < 1.0f) {
        bare.step(dt);
        time += dt;
    }
    const float quarter = 0.5f * std::numbers::pi_v<float> * std::sqrt(mass / stiffness);
    EXPECT_NEAR(time, quarter, 0.01f * quarter);
}

TEST(WallMotion, WallsAreWhereTheirBonesAre) {
    BareSkeleton bare;
    const patient::Posture posture{20.0f * degree, 15.0f * degree, 0.0f};
    bare.skeleton.reset(posture);
    PosedShell shell(bare.patient, bare.skeleton.bones(), &bare.skeleton);
    const DistanceGrid before = shell.distance();
    Coordinates offset;
    offset << 0.06f, 3e-3f, 0.08f, 4e-3f, 0.0f, -3e-3f, 0.0f;
    bare.skeleton.advance(offset, 1.0f);
    shell.yield();
    EXPECT_GT(shell.walls().travel(), 5e-3f);
    // Every vertex lies on its wall, up to the lattice's and the grid's resolution; before it did not.
    double squared = 0.0;
    double unmoved = 0.0;
    for (const Vec3f& vertex : shell.vertices()) {
        squared += std::pow(static_cast<double>(shell.walls().distance(vertex)), 2.0);
        unmoved += std::pow(static_cast<double>(before.distance(vertex)), 2.0);
    }
    const auto count = static_cast<double>(shell.vertices().size());
    EXPECT_LT(std::sqrt(squared / count), 0.4e-3);
    EXPECT_GT(std::sqrt(unmoved / count), 1e-3);
}

class SceneSkeletonTest : public ::testing::Test {
  protected:
    [[nodiscard]] Scene make(bool yields = true) const {
        return {test::coarse_newborn(), scope_, Tube{}, away_, Settings{.rigid = {}, .bones_yield = yields}};
    }
    [[nodiscard]] Inputs posed(float elevation, float opening) const {
        Inputs inputs = away_;
        inputs.runtime_parameters.head_elevation = elevation;
        inputs.runtime_parameters.jaw_opening = opening;
        return inputs;
    }
    /// The blade in the mouth, its tip over the tongue's highest point and `depth` [m] lower.
    [[nodiscard]] Inputs pressing(float depth) const {
        static const Vec3f dorsum = at(make().snapshot().landmarks, Landmark::tongue_dorsum);
        Inputs inputs = away_;
        inputs.laryngoscope = test::blade_with_tip_at(dorsum + Vec3f(0.0f, 0.0f, 6e-3f - depth), scope_);
        return inputs;
    }
    void press(Scene& scene, float depth) const {
        scene.place_laryngoscope(pressing(0.0f).laryngoscope);
        for (int k = 0; k < 120; ++k) {
            scene.step(pressing(depth * std::min(1.0f, static_cast<float>(k) / 60.0f)));
        }
    }
    Laryngoscope scope_ = make_laryngoscope(Blade::miller_1);
    Inputs away_ = test::parked_tools(20.0f, 15.0f);
};

TEST_F(SceneSkeletonTest, UntouchedBonesRestAndSleep) {
    Scene scene = make();
    test::hold(scene, away_, 60);
    EXPECT_LT(scene.skeleton()->offset().cwiseAbs().maxCoeff(), 1e-5f);
    EXPECT_EQ(scene.tissue().body().sleep.awake_groups(), 0u);
}

TEST_F(SceneSkeletonTest, PressedLarynxMovesSleepsAndReturns) {
    Scene scene = make();
    const auto glottis = [&] { return at(scene.snapshot().landmarks, Landmark::glottis); };
    const auto back = [&] { return scene.skeleton()->offset()[YieldingSkeleton::hyoid_back]; };
    const Vec3f rest = glottis();
    Inputs inputs = away_;
    inputs.runtime_parameters.laryngeal_pressure_back = 2.0f;
    inputs.runtime_parameters.laryngeal_pressure_right = 1.0f;
    test::hold(scene, inputs, 720);
    EXPECT_EQ(scene.snapshot().runtime_parameters.laryngeal_pressure_back, 2.0f);
    EXPECT_EQ(scene.tissue().body().sleep.awake_groups(), 0u);
    // The tongue, which hangs on the hyoid, holds some of the force.
    const float free_way =
        2.0f / (JointProperties{}.hyoid_forward * std::cbrt(test::coarse_newborn().weight / 3.5f));
    EXPECT_LT(back(), free_way);
    EXPECT_GT(back(), 0.5f * free_way);
    const Vec3f moved = glottis() - rest;
    // The front of the larynx goes with the hyoid, its back lies on the pharynx.
    EXPECT_GT(moved.y(), 0.3f * back());
    EXPECT_LT(moved.y(), back());
    EXPECT_LT(moved.x(), -0.3e-3f) << "to the patient's right";
    test::hold(scene, away_, 900);
    EXPECT_LT((glottis() - rest).norm(), 0.2e-3f);
    EXPECT_EQ(scene.tissue().body().sleep.awake_groups(), 0u);
}

TEST_F(SceneSkeletonTest, MuscleToneStiffensPressedBonesAtOnce) {
    Scene scene = make();
    Inputs inputs = away_;
    inputs.runtime_parameters.laryngeal_pressure_back = 2.0f;
    test::hold(scene, inputs, 720);
    ASSERT_EQ(scene.tissue().body().sleep.awake_groups(), 0u);
    const float relaxed = scene.skeleton()->offset()[YieldingSkeleton::hyoid_back];
    inputs.runtime_parameters.muscle_tone = 1.0f;
    test::hold(scene, inputs, 720);
    const float awake = scene.skeleton()->offset()[YieldingSkeleton::hyoid_back];
    EXPECT_LT(awake, 0.5f * relaxed) << "three times the stiffness, and the tongue's";
    EXPECT_GT(awake, relaxed / 3.0f - 1e-4f);
    EXPECT_EQ(scene.tissue().body().sleep.awake_groups(), 0u);
}

TEST_F(SceneSkeletonTest, ResetUnderPressureHasTheSameBits) {
    const auto hash = [&](bool before) {
        Scene scene = make();
        Inputs inputs = away_;
        inputs.runtime_parameters.laryngeal_pressure_back = 3.0f;
        inputs.runtime_parameters.muscle_tone = 0.3f;
        for (int k = 0; before && k < 60; ++k) {
            scene.step(inputs);
        }
        scene.reset(inputs);
        test::hold(scene, inputs, 60);
        return scene.state_hash();
    };
    EXPECT_EQ(hash(false), hash(true));
}

// Head and jaw moved as fast as a scene moves them, against a patient built in that posture.
TEST_F(SceneSkeletonTest, MovedPostureEndsWhereItWouldBeBuilt) {
    const Inputs to = posed(max_head_elevation, max_jaw_opening);
    Scene moved(test::coarse_newborn(), scope_, Tube{}, posed(0.0f, 0.0f), {});
    for (int k = 0; k < 6 * steps_per_second; ++k) {
        moved.step(to);
    }
    const Scene built(test::coarse_newborn(), scope_, Tube{}, to, {});
    const std::vector<Vec3f>& position = moved.tissue().body().particles.position;
    const std::vector<Vec3f>& expected = built.tissue().body().particles.position;
    for (std::size_t i = 0; i < position.size(); ++i) {
        ASSERT_LT((position[i] - expected[i]).norm(), 20e-6f) << "particle " << i;
    }
}

// Meanwhile, what holds the tongue from outside must not hold it back.
TEST_F(SceneSkeletonTest, TongueDoesNotLagBehindAMovingPosture) {
    Scene scene(test::coarse_newborn(), scope_, Tube{}, posed(0.0f, 0.0f), {});
    for (int k = 0; k < 2 * steps_per_second; ++k) {
        scene.step(posed(max_head_elevation, max_jaw_opening));
    }
    const pbd::Particles& particles = scene.tissue().body().particles;
    for (std::size_t i = 0; i < particles.size(); ++i) {
        if (scene.tissue().tongue().moves(i)) {
            ASSERT_LT((particles.position[i] - particles.rest[i]).norm(), 0.1e-3f) << "particle " << i;
        }
    }
}

TEST_F(SceneSkeletonTest, JawYieldsToThePressedTongueAndReturns) {
    Scene scene = make();
    press(scene, 14e-3f);
    const Coordinates pressed = scene.skeleton()->offset();
    EXPECT_GT(pressed[YieldingSkeleton::jaw_opening], 8e-3f) << pressed.transpose();
    EXPECT_LT(pressed.cwiseAbs().maxCoeff(), 0.3f) << pressed.transpose();
    scene.place_laryngoscope(away_.laryngoscope);
    test::hold(scene, away_, 900);
    EXPECT_LT(scene.skeleton()->offset().cwiseAbs().maxCoeff(), 0.02f);
}

TEST_F(SceneSkeletonTest, YieldingBonesTakeForceOffTheBlade) {
    const auto force = [&](bool yields) {
        Scene scene = make(yields);
        press(scene, 14e-3f);
        return scene.snapshot().tissue_force.norm() + scene.snapshot().shell_force.norm();
    };
    const float held = force(false);
    EXPECT_GT(held, 1.0f);
    const float yielding = force(true);
    EXPECT_LT(yielding, 0.9f * held);
}

TEST_F(SceneSkeletonTest, ThreadsDoNotChangeBits) {
    const auto hash = [&](std::size_t threads) {
        return test::with_threads(threads, [&] {
            Scene scene = make();
            press(scene, 8e-3f);
            return scene.state_hash();
        });
    };
    EXPECT_EQ(hash(1), hash(4));
}

TEST_F(SceneSkeletonTest, StepsDoNotAllocate) {
    Scene scene = make();
    press(scene, 8e-3f);
    const Inputs held = pressing(8e-3f);
    scene.step(held);
    const long before = test::allocations();
    scene.step(held);
    EXPECT_EQ(test::allocations(), before);
}

// As a jaw that hands hold open, let go, shut and thrown open again within a step each.
TEST_F(SceneSkeletonTest, JawThrownAboutComesToRest) {
    Settings settings{.rate_scale = 1000.0f, .rigid = {}};
    Scene scene(test::coarse_newborn(), scope_, Tube{}, away_, settings);
    for (const float opening : {0.0f, 35.0f, 0.0f, 15.0f}) {
        Inputs inputs = away_;
        inputs.runtime_parameters.jaw_opening = opening * degree;
        for (int k = 0; k < 30; ++k) {
            scene.step(inputs);
            ASSERT_TRUE(scene.skeleton()->offset().allFinite());
            ASSERT_LT(scene.skeleton()->offset().cwiseAbs().maxCoeff(), 0.5f);
        }
    }
    test::hold(scene, away_, 540);
    EXPECT_LT(scene.skeleton()->offset().cwiseAbs().maxCoeff(), 2e-3f);
}

TEST_F(SceneSkeletonTest, BonesYieldWithoutSleep) {
    Settings settings{.rigid = {}, .sleep = false};
    Scene scene(test::coarse_newborn(), scope_, Tube{}, away_, settings);
    press(scene, 14e-3f);
    EXPECT_GT(scene.skeleton()->offset()[YieldingSkeleton::jaw_opening], 8e-3f);
}

TEST_F(SceneSkeletonTest, ResetForgetsLoads) {
    Scene scene = make();
    press(scene, 14e-3f);
    scene.reset(away_);
    scene.step(away_);
    EXPECT_LT(scene.skeleton()->offset().cwiseAbs().maxCoeff(), 1e-7f);
}

// The hand's greatest force is 60 N; the blade that tissue meets must not stay behind before.
TEST_F(SceneSkeletonTest, BladeOnTheGumIsWhereItsProxyIs) {
    Scene scene = make();
    Inputs inputs = pressing(4e-3f);
    scene.place_laryngoscope(inputs.laryngoscope);
    float largest = 0.0f;
    for (int k = 0; k < 90; ++k) {
        // The blade's middle is drawn up against the gum.
        inputs.laryngoscope.translation.z() += 0.3e-3f;
        scene.step(inputs);
        const Snapshot& s = scene.snapshot();
        largest = std::max(largest, s.shell_force.norm());
        ASSERT_LT((s.last_free.translation - s.proxy.translation).norm(), 0.2e-3f)
            << s.shell_force.norm() << " N";
    }
    EXPECT_GT(largest, 5.0f);
}

}  // namespace
}  // namespace eti::scene
