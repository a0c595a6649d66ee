// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "common/math/units.hpp"
#include "tests/support/coarse_newborn.hpp"
#include "tests/support/newborn_scene.hpp"

namespace eti::scene {
namespace {

/// Blade on the tongue of a newborn whose stress relaxes: by method, and whether bones yield.
class SceneRelaxationTest : public ::testing::TestWithParam<bool> {
  protected:
    [[nodiscard]] Scene make(bool relaxes = true) const {
        return {test::coarse_newborn(), scope_, Tube{}, away_,
                Settings{.rigid = {}, .bones_yield = GetParam(), .relaxation = relaxes}};
    }
    /// The blade in the mouth, its tip over the tongue's highest point and `depth` [m] lower.
    [[nodiscard]] Inputs pressing(float depth) const {
        static const Vec3f dorsum = at(make().snapshot().landmarks, Landmark::tongue_dorsum);
        Inputs inputs = away_;
        inputs.laryngoscope = test::blade_with_tip_at(dorsum + Vec3f(0.0f, 0.0f, 6e-3f - depth), scope_);
        return inputs;
    }
    /// Presses within a third of a second and holds for four seconds; returns the force [N] of each step.
    [[nodiscard]] std::vector<float> press(Scene& scene) const {
        scene.place_laryngoscope(pressing(0.0f).laryngoscope);
        std::vector<float> force;
        for (int k = 0; k < 60 + 720; ++k) {
            scene.step(pressing(12e-3f * std::min(1.0f, static_cast<float>(k) / 60.0f)));
            force.push_back(scene.snapshot().tissue_force.norm());
        }
        return force;
    }
    [[nodiscard]] static float farthest_from_rest(const Scene& scene) {
        const pbd::Particles& p = scene.tissue().body().particles;
        float most = 0.0f;
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (scene.tissue().tongue().moves(i)) {
                most = std::max(most, (p.position[i] - p.rest[i]).norm());
            }
        }
        return most;
    }
    Laryngoscope scope_ = make_laryngoscope(Blade::miller_1);
    Inputs away_ = test::parked_tools(20.0f, 15.0f);
};

TEST_P(SceneRelaxationTest, UntouchedPatientSleeps) {
    Scene scene = make();
    test::hold(scene, away_, 60);
    EXPECT_EQ(scene.tissue().body().sleep.awake_groups(), 0u);
}

TEST_P(SceneRelaxationTest, ForceOfAHeldBladeFalls) {
    const auto share = [&](bool relaxes) {
        Scene scene = make(relaxes);
        const std::vector<float> force = press(scene);
        EXPECT_GT(force[60], 0.2f);
        return force.back() / force[60];
    };
    const float relaxing = share(true);
    const float elastic = share(false);
    EXPECT_LT(relaxing, 0.93f * elastic);
    // Nothing falls farther than the material does, but for tissue that slips off.
    EXPECT_GT(relaxing, 0.6f * elastic);
}

// Half a minute after the blade has gone, during which nothing touches it.
TEST_P(SceneRelaxationTest, TongueReturnsToRestAndSleeps) {
    Scene scene = make();
    (void)press(scene);
    scene.place_laryngoscope(away_.laryngoscope);
    for (int k = 0; k < 5400 && scene.tissue().body().sleep.mesh_awake(); ++k) {
        scene.step(away_);
    }
    EXPECT_FALSE(scene.tissue().body().sleep.mesh_awake());
    EXPECT_LT(farthest_from_rest(scene), 1e-5f);
}

TEST_P(SceneRelaxationTest, ResetForgets) {
    Scene scene = make();
    (void)press(scene);
    scene.reset(away_);
    Scene fresh = make();
    const std::vector<float> expected = press(fresh);
    EXPECT_EQ(press(scene), expected);
}

INSTANTIATE_TEST_SUITE_P(YieldingBones, SceneRelaxationTest, ::testing::Bool());

}  // namespace
}  // namespace eti::scene
