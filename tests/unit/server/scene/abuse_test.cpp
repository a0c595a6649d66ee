// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// What hands should never do to a newborn: nothing becomes infinite, and once the tools are away the tissue
// comes back to its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "common/model/landmark.hpp"
#include "tests/support/coarse_newborn.hpp"
#include "tests/support/newborn_scene.hpp"

namespace eti::scene {
namespace {

constexpr float back_within = 2.0f;       // [s]
constexpr float farthest_throw = 60e-3f;  // [m], of any particle: a newborn's mouth
constexpr float largest_change = 12.0f;   // [N] per step, of the tissue's force on the blade

/// Hands at rest beside the head, and a mouth to abuse.
struct Hands {
    Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    Inputs away = test::parked_tools(20.0f, 25.0f);
    Vec3f dorsum = Vec3f::Zero(), gum = Vec3f::Zero(), glottis = Vec3f::Zero();

    Hands() {
        const Scene scene(test::coarse_newborn(), scope, Tube{}, away, {});
        dorsum = at(scene.snapshot().landmarks, Landmark::tongue_dorsum);
        gum = at(scene.snapshot().landmarks, Landmark::upper_gum);
        glottis = at(scene.snapshot().landmarks, Landmark::glottis_posterior);
    }
    /// The blade pointing posterior, its tip at an offset [m] from the tongue's highest point, rolled about
    /// its axis [rad].
    [[nodiscard]] RigidTransform blade(const Vec3f& tip, float roll = 0.0f) const {
        const Quatf turn = Quatf(Eigen::AngleAxisf(roll, Vec3f::UnitY())) *
                           Quatf(Eigen::AngleAxisf(-90.0f * degree, Vec3f::UnitX()));
        return {turn, dorsum + tip - turn * scope.tip()};
    }
    /// The same, pitched about the upper gum [rad], tip up.
    [[nodiscard]] RigidTransform pitched(const Vec3f& tip, float pitch) const {
        return RigidTransform::about(gum, Vec3f::UnitX(), -pitch) * blade(tip);
    }
};

const Hands& hands() {
    static const Hands hands;
    return hands;
}

/// Inputs over the time of an abuse, from 0 to 1.
struct Abuse {
    const char* name;
    float seconds;
    std::function<void(float, Inputs&)> at;
    Settings settings{.rigid = {}, .relaxation = true};
    float back_to = 10e-6f;  ///< [m] from rest afterwards
};

void PrintTo(const Abuse& abuse, std::ostream* out) {
    *out << abuse.name;
}

/// From 0 to 1 between two times.
float ramp(float t, float from, float to) {
    return std::clamp((t - from) / (to - from), 0.0f, 1.0f);
}

Settings at_once() {
    return {.rate_scale = 1000.0f, .rigid = {}, .relaxation = true};
}

const Vec3f above{0.0f, 0.0f, 6e-3f};
const Vec3f behind{0.0f, 15e-3f, -9e-3f};

std::vector<Abuse> abuses() {
    std::vector<Abuse> all;
    all.push_back({"Through", 1.0f, [](float t, Inputs& in) {
                       const float depth = 20e-3f * (ramp(t, 0.0f, 0.5f) - ramp(t, 0.7f, 1.0f));
                       in.laryngoscope = hands().blade(above - Vec3f(0.0f, 0.0f, depth),
                                                       40.0f * degree * ramp(t, 0.2f, 0.6f));
                   }});
    all.push_back({"Scoop", 1.5f, [](float t, Inputs& in) {
                       const Vec3f side(15e-3f * (1.0f - ramp(t, 0.0f, 0.4f)), 5e-3f, -5e-3f);
                       const Vec3f heave = 20e-3f * ramp(t, 0.6f, 1.0f) * Vec3f(0.0f, -0.8f, 0.6f);
                       in.laryngoscope = hands().blade(side + heave, 150.0f * degree * ramp(t, 0.2f, 0.6f));
                   }});
    all.push_back({"Heave", 1.0f, [](float t, Inputs& in) {
                       const Vec3f lift = 40e-3f * ramp(t, 0.3f, 1.0f) * Vec3f(0.0f, -0.8f, 0.6f);
                       in.laryngoscope = hands().blade(behind + lift);
                   }});
    all.push_back({"HeaveInAnInstant", 0.5f, [](float t, Inputs& in) {
                       const Vec3f lift = 40e-3f * ramp(t, 0.5f, 0.54f) * Vec3f(0.0f, -0.8f, 0.6f);
                       in.laryngoscope = hands().blade(behind + lift);
                   }});
    all.push_back({"Lever", 1.5f, [](float t, Inputs& in) {
                       in.laryngoscope = hands().pitched(behind, 45.0f * degree * ramp(t, 0.3f, 0.9f));
                   }});
    all.push_back({"Ram", 0.5f, [](float t, Inputs& in) {
                       in.laryngoscope =
                           hands().blade(above - Vec3f(0.0f, 0.0f, 30e-3f * ramp(t, 0.4f, 0.41f)));
                   }});
    all.push_back({"JawFlap", 1.0f,
                   [](float t, Inputs& in) {
                       const std::array<float, 4> opening = {25.0f, 0.0f, 35.0f, 25.0f};
                       in.runtime_parameters.jaw_opening =
                           degree * opening[static_cast<std::size_t>(3.99f * t)];
                   },
                   at_once(),
                   // No tool is near: what has relaxed comes back as slowly as it went.
                   100e-6f});
    all.push_back({"LiveTissue", 2.0f,
                   [](float t, Inputs& in) {
                       const std::array<float, 4> kilopascal = {8.0f, 100.0f, 1.0f, 8.0f};
                       const std::array<float, 4> scale = {1.0f, 1.4f, 0.8f, 1.0f};
                       const auto now = static_cast<std::size_t>(3.99f * t);
                       in.runtime_parameters.tissue_stiffness = 1e3f * kilopascal[now];
                       in.runtime_parameters.tongue_scale = scale[now];
                       in.laryngoscope =
                           hands().blade(above - Vec3f(0.0f, 0.0f, 10e-3f * ramp(t, 0.0f, 0.2f)));
                   },
                   at_once()});
    all.push_back({"TableTilt", 2.0f,
                   [](float t, Inputs& in) {
                       in.runtime_parameters.table_angle = (t < 0.5f ? 20.0f : -20.0f) * degree;
                       in.laryngoscope =
                           hands().blade(above - Vec3f(0.0f, 0.0f, 10e-3f * ramp(t, 0.0f, 0.2f)));
                       if (t > 0.95f) {
                           in.runtime_parameters.table_angle = 0.0f;
                       }
                   },
                   at_once()});
    all.push_back({"Cram", 2.0f, [](float t, Inputs& in) {
                       in.laryngoscope = hands().blade(behind);
                       // The tube's grip over the mouth, pushed at the throat by 0.3 m/s and turned by half a
                       // turn.
                       const Quatf down(Eigen::AngleAxisf(-60.0f * degree, Vec3f::UnitX()));
                       const Quatf twist(
                           Eigen::AngleAxisf(180.0f * degree * ramp(t, 0.2f, 0.9f), Vec3f::UnitZ()));
                       const Vec3f from = hands().gum + Vec3f(-6e-3f, -90e-3f, 40e-3f);
                       const Vec3f to = hands().dorsum + Vec3f(-4e-3f, -30e-3f, 10e-3f);
                       in.tube_grip = {down * twist, from + ramp(t, 0.1f, 0.25f) * (to - from)};
                   }});
    all.push_back({"PressedLarynx", 1.5f,
                   [](float t, Inputs& in) {
                       in.runtime_parameters.laryngeal_pressure_back = t < 0.8f ? 10.0f : 0.0f;
                       in.runtime_parameters.laryngeal_pressure_right = t < 0.8f ? 5.0f : 0.0f;
                       in.laryngoscope = hands().blade(behind);
                   },
                   at_once()});
    return all;
}

class AbusedSceneTest : public ::testing::TestWithParam<Abuse> {};

TEST_P(AbusedSceneTest, StaysFiniteAndComesBack) {
    const Abuse& abuse = GetParam();
    Inputs inputs = hands().away;
    abuse.at(0.0f, inputs);
    Scene scene(test::coarse_newborn(), hands().scope, Tube{}, inputs, abuse.settings);
    const pbd::Particles& p = scene.tissue().body().particles;
    const auto farthest = [&] {
        float most = 0.0f;
        for (std::size_t i = 0; i < p.size(); ++i) {
            const float away = (p.position[i] - p.rest[i]).norm();
            if (!std::isfinite(away)) {
                return away;
            }
            most = std::max(most, scene.tissue().tongue().moves(i) ? away : 0.0f);
        }
        return most;
    };
    float thrown = 0.0f;
    float change = 0.0f;
    float force = 0.0f;
    const auto step = [&] {
        scene.step(inputs);
        thrown = std::max(thrown, farthest());
        const float now = scene.snapshot().tissue_force.norm();
        change = std::max(change, std::abs(now - force));
        force = now;
    };
    const int steps = static_cast<int>(abuse.seconds * steps_per_second);
    for (int k = 0; k <= steps; ++k) {
        inputs = hands().away;
        abuse.at(static_cast<float>(k) / static_cast<float>(steps), inputs);
        step();
        ASSERT_TRUE(std::isfinite(thrown)) << "step " << k;
    }
    EXPECT_LT(thrown, farthest_throw);
    EXPECT_LT(change, largest_change);
    inputs = hands().away;
    scene.place_laryngoscope(inputs.laryngoscope);
    scene.place_tube(inputs.tube_grip);
    for (int k = 0; k < static_cast<int>(back_within * steps_per_second); ++k) {
        step();
    }
    EXPECT_LT(farthest(), abuse.back_to);
    EXPECT_EQ(scene.snapshot().tissue_force.norm(), 0.0f);
    RecordProperty("thrown_mm", std::to_string(1e3f * thrown));
    RecordProperty("change_n", std::to_string(change));
}

INSTANTIATE_TEST_SUITE_P(Abuses, AbusedSceneTest, ::testing::ValuesIn(abuses()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace eti::scene
