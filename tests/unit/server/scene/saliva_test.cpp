// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/scene/saliva.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/app/run/patient_cache.hpp"
#include "server/scene/posed_shell.hpp"
#include "server/scene/tissue.hpp"
#include "tests/support/newborn_scene.hpp"
#include "tests/support/threads.hpp"

namespace eti::scene {
namespace {

/// The newborn of the premature scenarios; only its skin is coarser.
const patient::Patient& premature() {
    static const patient::Patient patient = app::cached_patient(
        {.weight = 1.1f, .gestational_age = 28.0f, .tongue_scale = 1.15f}, {.surface_spacing = 2.5e-3f});
    return patient;
}

/// Tissue at rest in one posture, tools far away, and saliva.
class Mouth {
  public:
    explicit Mouth(const patient::Posture& posture, LiquidKind kind = LiquidKind::saliva)
        : bones(patient::pose_bones(premature().skeleton, posture)),
          tissue(premature(), TissueMethod::clusters, step_duration / 8),
          shell(premature(), bones),
          saliva(premature(), make_laryngoscope(Blade::miller_0), 1.8e-3f, 1, kind) {
        tissue.pose(bones);
        tissue.reset();
        std::vector<FramePose> frames;
        tissue.frames(frames);
        for (std::size_t i = 0; i < landmark_count; ++i) {
            const patient::CarriedPoint& point = premature().landmarks[i];
            landmarks[i] = skin_point(point.rest, point.skin, premature().frame_rest_centre, frames);
        }
        blade.translation = Vec3f(0.0f, -0.3f, 0.2f);
        saliva.reset(surroundings());
    }

    [[nodiscard]] SalivaSurroundings surroundings(float suction = 0.0f) const {
        return {shell.distance(),
                shell.revision(),
                tissue.body().particles,
                bones,
                landmarks,
                blade,
                blade,
                {},
                {},
                suction};
    }

    void step(int steps, float suction = 0.0f) {
        for (int k = 0; k < steps; ++k) {
            saliva.begin_step(surroundings(suction));
            saliva.end_step();
        }
    }

    [[nodiscard]] std::span<const Vec3f> liquid() const { return saliva.fluid().positions(); }

    patient::BonePoses bones;
    SoftTissue tissue;
    PosedShell shell;
    Landmarks landmarks{};
    RigidTransform blade;
    Saliva saliva;
};

float nearest(const pbd::Particles& tissue, Tissue kind, const Vec3f& point) {
    float best = 1.0f;
    for (std::size_t i = 0; i < tissue.size(); ++i) {
        if (static_cast<Tissue>(tissue.object[i]) == kind) {
            best = std::min(best, (tissue.position[i] - point).norm() - tissue.radius[i]);
        }
    }
    return best;
}

class SalivaInPosture : public ::testing::TestWithParam<float> {};

TEST_P(SalivaInPosture, NothingLeaksThroughTheShell) {
    Mouth mouth({26.0f * degree, GetParam() * degree});
    const std::size_t at_first = mouth.liquid().size();
    ASSERT_GT(at_first, 500u) << "the pool of the start";
    for (int k = 0; k < 12; ++k) {
        mouth.step(15);
        for (const Vec3f& x : mouth.liquid()) {
            // Particles stay half a spacing from the wall, in corners 0.4 (FluidWalls); the shell's grid has
            // cells of a spacing, whose trilinear edges are rounder than the wall: the rest of the half.
            ASSERT_GT(mouth.shell.distance().distance(x), 0.0f) << "step " << 15 * (k + 1);
        }
    }
    EXPECT_GE(mouth.liquid().size(), at_first);
    EXPECT_EQ(mouth.saliva.fluid().left_domain(), 0u);
}

INSTANTIATE_TEST_SUITE_P(JawOpening, SalivaInPosture, ::testing::Values(0.0f, 13.0f, 26.0f));

TEST(Saliva, LiesOnTongueSurface) {
    Mouth mouth({26.0f * degree, 24.0f * degree});
    mouth.step(90);
    pbd::Particles& tissue = mouth.tissue.body().particles;
    const auto on_tongue = [&] {
        int count = 0;
        for (const Vec3f& x : mouth.liquid()) {
            const float gap = nearest(tissue, Tissue::tongue, x);
            EXPECT_GT(gap, 0.0f) << "inside one of the tongue's particles";
            // Touching a ball of 1.6 radii, or two of them across a hollow.
            count += gap < 2e-3f ? 1 : 0;
        }
        return count;
    };
    EXPECT_GT(on_tongue(), 50);
    // It is lifted with the tongue: 3 mm at 36 mm/s, as by a blade.
    for (int k = 0; k < 15; ++k) {
        for (std::size_t i = 0; i < tissue.size(); ++i) {
            if (static_cast<Tissue>(tissue.object[i]) == Tissue::tongue) {
                tissue.position[i] -= Vec3f(0.0f, 0.2e-3f, 0.0f);
            }
        }
        mouth.step(1);
    }
    mouth.step(5);
    EXPECT_GT(on_tongue(), 30);
}

TEST(Saliva, WallIsUpdatedOnlyNearMotion) {
    Mouth mouth({26.0f * degree, 24.0f * degree});
    mouth.step(20);
    mouth.step(2);  // the wall is updated every second step
    const std::size_t at_rest = mouth.saliva.wall().nodes();
    pbd::Particles& tissue = mouth.tissue.body().particles;
    const Vec3f wet = mouth.liquid().front();
    for (Vec3f& p : tissue.position) {
        if ((p - wet).norm() < 5e-3f) {
            p.y() += 0.1e-3f;
        }
    }
    mouth.step(1);
    EXPECT_GT(mouth.saliva.wall().nodes(), at_rest + 64);
    mouth.step(2);
    EXPECT_LT(mouth.saliva.wall().nodes(), at_rest + 64 * 50) << "blocks into which liquid runs";
    // The updated boundary equals one built from scratch.
    LiquidBoundary anew(2e-3f, 0.6e-3f);
    anew.update(mouth.shell.distance(), mouth.shell.revision(), tissue, mouth.liquid());
    LiquidBoundary kept(2e-3f, 0.6e-3f);
    for (const float lift : {0.1e-3f, -0.1e-3f}) {
        tissue.position[tissue.size() / 2].y() += lift;
        for (Vec3f& p : tissue.position) {
            p.z() += lift;
        }
        kept.update(mouth.shell.distance(), mouth.shell.revision(), tissue, mouth.liquid());
    }
    for (const Vec3f& x : mouth.liquid()) {
        // Floats of 0.1 m that were moved there and back, by more than the threshold for unmoved ones.
        ASSERT_NEAR(kept.distance().distance(x), anew.distance().distance(x), 10e-6f);
    }
}

TEST(Saliva, SuctionAtBladeTipRemovesIt) {
    Mouth mouth({26.0f * degree, 24.0f * degree});
    mouth.step(60);
    // The tip at the pool's deepest point.
    const Vec3f deepest = *std::max_element(mouth.liquid().begin(), mouth.liquid().end(),
                                            [](const Vec3f& a, const Vec3f& b) { return a.y() < b.y(); });
    mouth.blade =
        test::blade_with_tip_at(deepest - Vec3f(0.0f, 2e-3f, 0.0f), make_laryngoscope(Blade::miller_0));
    mouth.step(1, 0.0f);
    EXPECT_EQ(mouth.saliva.fluid().aspirated(), 0u);
    const std::size_t before = mouth.liquid().size();
    mouth.step(30, 1.0f);
    const std::uint64_t taken = mouth.saliva.fluid().aspirated();
    EXPECT_GT(taken, 20u);
    // The glands' output meanwhile is a particle or two.
    EXPECT_NEAR(static_cast<double>(mouth.liquid().size() + taken), static_cast<double>(before), 4.0);
}

TEST(Saliva, GlandsSecreteTheSetFlow) {
    Mouth mouth({26.0f * degree, 24.0f * degree});
    const std::size_t before = mouth.liquid().size();
    mouth.step(2 * steps_per_second);
    // Four glands of 2 ul/s in a newborn of 3.5 kg; each may be behind by a particle.
    const double given = 2.0 * 4.0 * 2e-9 * (1.1 / 3.5);
    const double particles = given / static_cast<double>(mouth.saliva.fluid().particle_volume());
    EXPECT_NEAR(static_cast<double>(mouth.liquid().size() - before), particles, 4.5);
}

// Thinner, and with less adhesion: the initial liquid on the tongue runs down faster.
TEST(Saliva, BloodRunsFasterThanSaliva) {
    const auto speed = [](LiquidKind kind) {
        Mouth mouth({26.0f * degree, 24.0f * degree}, kind);
        double sum = 0.0;
        for (int k = 0; k < steps_per_second; ++k) {
            mouth.step(1);
            for (const Vec3f& v : mouth.saliva.fluid().velocities()) {
                sum += static_cast<double>(v.norm());
            }
        }
        return sum;
    };
    EXPECT_GT(speed(LiquidKind::blood), 1.1 * speed(LiquidKind::saliva));
    const pbd::FluidSettings blood = saliva_settings(0.85e-3f, step_duration / 4, LiquidKind::blood);
    const LiquidProperties& known = properties_of(LiquidKind::blood);
    EXPECT_EQ(blood.rest_density, known.density);
    EXPECT_EQ(blood.viscosity, known.viscosity);
    EXPECT_EQ(blood.wall_viscosity, known.wall_viscosity);
    EXPECT_LE(blood.surface_tension, known.surface_tension);
}

class SalivaInScene : public ::testing::Test {
  protected:
    [[nodiscard]] Scene make(bool saliva) const {
        return {
            premature(), make_laryngoscope(Blade::miller_0), Tube{}, away_, {.rigid = {}, .saliva = saliva}};
    }
    Inputs away_ = test::parked_tools(26.0f, 24.0f);
};

TEST_F(SalivaInScene, IsAbsentUnlessEnabled) {
    Scene scene = make(false);
    scene.step(away_);
    EXPECT_FALSE(scene.snapshot().saliva.on);
    EXPECT_TRUE(scene.snapshot().saliva.positions.empty());
    EXPECT_EQ(scene.snapshot().saliva.positions.capacity(), 0u);
}

TEST_F(SalivaInScene, SameBitsForAnyNumberOfThreads) {
    const auto run = [&](std::size_t threads) {
        return test::with_threads(threads, [&] {
            Scene scene = make(true);
            test::hold(scene, away_, 20);
            return scene.state_hash();
        });
    };
    const std::uint64_t one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(8), one);
}

TEST_F(SalivaInScene, ResetRestoresPool) {
    Scene scene = make(true);
    const std::vector<Vec3f> pool = scene.snapshot().saliva.positions;
    const auto run = [&] {
        test::hold(scene, away_, 10);
        return scene.snapshot().saliva.positions;
    };
    const std::vector<Vec3f> first = run();
    EXPECT_NE(first, pool);
    scene.reset(away_);
    EXPECT_EQ(scene.snapshot().saliva.positions, pool);
    EXPECT_EQ(run(), first);
}

TEST_F(SalivaInScene, ChangesStateHash) {
    Scene with = make(true), same = make(true), without = make(false);
    EXPECT_EQ(with.state_hash(), same.state_hash());
    EXPECT_NE(with.state_hash(), without.state_hash());
    for (int step = 0; step < 3; ++step) {
        const auto before = with.state_hash();
        with.step(away_);
        same.step(away_);
        EXPECT_EQ(with.state_hash(), same.state_hash());
        EXPECT_NE(with.state_hash(), before) << "the liquid settles";
    }
}

TEST_F(SalivaInScene, BloodChangesStateHash) {
    const auto hash = [&](LiquidKind kind) {
        Scene scene(premature(), make_laryngoscope(Blade::miller_0), Tube{}, away_,
                    {.rigid = {}, .saliva = true, .liquid = kind});
        test::hold(scene, away_, 5);
        return scene.state_hash();
    };
    EXPECT_NE(hash(LiquidKind::blood), hash(LiquidKind::saliva));
}

TEST_F(SalivaInScene, StandbyStaysDryUntilSecretionIsSet) {
    Inputs inputs = away_;
    inputs.runtime_parameters.secretion = 0.0f;
    Scene scene(premature(), make_laryngoscope(Blade::miller_0), Tube{}, inputs,
                {.rigid = {}, .saliva = true, .dry_start = true});
    test::hold(scene, inputs, 20);
    EXPECT_TRUE(scene.snapshot().saliva.on);
    EXPECT_TRUE(scene.snapshot().saliva.positions.empty());
    inputs.runtime_parameters.secretion = 10.0f;
    test::hold(scene, inputs, 2 * steps_per_second);
    EXPECT_NEAR(scene.snapshot().runtime_parameters.secretion, 10.0f, 1e-3f);
    // It takes two seconds to request ten times the flow, five more of it in each; each gland may be behind
    // by a particle. None has run out yet.
    const double given = 10.0 * 1.0 * 4.0 * 2e-9 * (1.1 / 3.5);
    const double particle = std::pow(static_cast<double>(scene.snapshot().saliva.spacing), 3);
    EXPECT_NEAR(static_cast<double>(scene.snapshot().saliva.positions.size()), given / particle, 5.0);
    inputs.runtime_parameters.secretion = 0.0f;
    test::hold(scene, inputs, 3 * steps_per_second);
    const std::size_t there = scene.snapshot().saliva.positions.size() + scene.snapshot().saliva.left;
    test::hold(scene, inputs, steps_per_second / 2);
    EXPECT_EQ(scene.snapshot().saliva.positions.size() + scene.snapshot().saliva.left, there);
}

TEST_F(SalivaInScene, RunsToLowerEndOfTable) {
    const auto middle = [&](float table_angle) {
        Inputs inputs = away_;
        inputs.runtime_parameters.table_angle = table_angle;
        Scene scene(premature(), make_laryngoscope(Blade::miller_0), Tube{}, inputs,
                    {.rigid = {}, .saliva = true});
        test::hold(scene, inputs, 2 * steps_per_second);
        float z = 0.0f;
        for (const Vec3f& p : scene.snapshot().saliva.positions) {
            z += p.z() / static_cast<float>(scene.snapshot().saliva.positions.size());
        }
        return z;
    };
    const float head_down = middle(-max_table_angle);
    const float level = middle(0.0f);
    const float head_up = middle(max_table_angle);
    // More than a particle's displacement.
    EXPECT_GT(head_down, level + 0.3e-3f);
    EXPECT_LT(head_up, level - 0.3e-3f);
}

}  // namespace
}  // namespace eti::scene
