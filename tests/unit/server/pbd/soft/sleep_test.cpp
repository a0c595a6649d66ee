// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/sleep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "server/pbd/contact/self_contact.hpp"
#include "tests/support/cluster_block.hpp"
#include "tests/support/threads.hpp"

namespace eti::pbd {
namespace {

constexpr int sleep_substeps = 8;
constexpr float sleep_dt = 1.0f / (180.0f * sleep_substeps);  // [s]
constexpr Sleep::Settings sleep_settings;

using Tool = std::function<void(Particles&)>;  ///< modifies predicted positions

/// A cube of 24 mm in blocks of clusters, fixed by its uppermost layers.
class SleepTest : public ::testing::Test {
  protected:
    static constexpr int n = 13;

    [[nodiscard]] static SoftBody cube(bool sleeps) {
        SoftBody body = test::cluster_block(n, 8e3f, Vec3f::Zero(), 2);
        body.settings.damping = 60.0f;
        if (sleeps) {
            body.enable_sleeping({}, sleep_settings);
        }
        return body;
    }

    static void step(SoftBody& body, const Tool& tool = {}) {
        body.begin_step();
        for (int s = 0; s < sleep_substeps; ++s) {
            body.predict(sleep_dt, 1.0f / static_cast<float>(sleep_substeps - s));
            body.project(sleep_dt);
            if (tool) {
                tool(body.particles);
            }
            body.finish(sleep_dt);
        }
        body.end_step();
    }

    static void rest(SoftBody& body) {
        for (int k = 0; k <= sleep_settings.steps; ++k) {
            step(body);
        }
    }

    [[nodiscard]] static SoftBody sleeping_cube() {
        SoftBody body = cube(true);
        rest(body);
        EXPECT_EQ(body.sleep.awake_groups(), 0u);
        return body;
    }

    /// Wakes everything within 3 mm of a corner at the cube's free end.
    static void touch_corner(SoftBody& body) {
        const Eigen::AlignedBox3f box(Vec3f::Constant(-3e-3f), Vec3f::Constant(3e-3f));
        body.sleep.wake_near(body.particles, box, [](const Vec3f&, float) { return true; });
    }

    /// Holds the corner's particle at `x` [m] from its rest position.
    [[nodiscard]] static Tool pull(float x) {
        return [x](Particles& p) { p.predicted[0] = p.rest[0] + Vec3f(x, 0, 0); };
    }

    [[nodiscard]] static float apart(const SoftBody& a, const SoftBody& b) {
        float most = 0.0f;
        for (std::size_t i = 0; i < a.particles.size(); ++i) {
            most = std::max(most, (a.particles.position[i] - b.particles.position[i]).norm());
        }
        return most;
    }
};

TEST_F(SleepTest, RestingBodySleepsAndIsNotSolved) {
    SoftBody body = cube(true);
    for (int k = 0; k < sleep_settings.steps; ++k) {
        step(body);
        EXPECT_TRUE(body.sleep.all_awake()) << k;
    }
    step(body);
    EXPECT_EQ(body.sleep.awake_groups(), 0u);
    EXPECT_GT(body.sleep.groups(), 20u);
    body.begin_step();
    EXPECT_TRUE(body.particles.awake.empty());
    // If it were solved, it would return from here.
    body.particles.position[0].x() += 1e-3f;
    const std::vector<Vec3f> before = body.particles.position;
    step(body);
    EXPECT_EQ(body.particles.position, before);
    EXPECT_EQ(body.particles.mobility(0), 0.0f);
}

TEST_F(SleepTest, DisabledSleepingKeepsBodyAwake) {
    SoftBody body = cube(false);
    for (int k = 0; k < 3 * sleep_settings.steps; ++k) {
        step(body);
    }
    EXPECT_EQ(body.particles.awake.size(), 1u);
    EXPECT_GT(body.particles.mobility(0), 0.0f);
}

TEST_F(SleepTest, ToolWakesOnlyNearbyGroups) {
    SoftBody body = sleeping_cube();
    const Eigen::AlignedBox3f box(Vec3f::Constant(-3e-3f), Vec3f::Constant(3e-3f));
    body.sleep.wake_near(body.particles, box, [](const Vec3f&, float) { return false; });
    EXPECT_EQ(body.sleep.awake_groups(), 0u);
    touch_corner(body);
    EXPECT_GT(body.sleep.awake_groups(), 0u);
    EXPECT_LT(2 * body.sleep.awake_groups(), body.sleep.groups());
    EXPECT_GT(body.particles.mobility(0), 0.0f);
    EXPECT_EQ(body.particles.mobility(body.particles.size() / 2), 0.0f);
    // Undisturbed, it falls asleep again.
    rest(body);
    EXPECT_EQ(body.sleep.awake_groups(), 0u);
}

TEST_F(SleepTest, SetRestAndResetWakeWholeBody) {
    SoftBody body = sleeping_cube();
    body.set_rest();
    EXPECT_TRUE(body.sleep.all_awake());
    rest(body);
    EXPECT_EQ(body.sleep.awake_groups(), 0u);
    body.reset();
    EXPECT_TRUE(body.sleep.all_awake());
    step(body);
    EXPECT_EQ(body.particles.awake.size(), 1u);
    EXPECT_EQ(std::ranges::count(body.particles.asleep, 1), 0);
}

TEST_F(SleepTest, SleepingBodyFollowsSlowDrift) {
    SoftBody body = sleeping_cube();
    SoftBody awake = cube(false);
    constexpr float drift = 0.1e-6f;  // [m] per step, 18 um/s
    constexpr int steps = 3000;
    std::array<float, 2> most{};
    int wakings = 0;
    for (int k = 0; k < steps; ++k) {
        touch_corner(body);
        const std::size_t before = body.sleep.awake_groups();
        const Tool tool = pull(drift * static_cast<float>(k));
        step(body, tool);
        step(awake, tool);
        wakings += body.sleep.awake_groups() > before ? 1 : 0;
        float& half = most[2 * k < steps ? 0 : 1];
        half = std::max(half, apart(body, awake));
    }
    // Sleeping neighbours hold particles shared with the pulled block, so that it moves by `shift` only when
    // it would otherwise have moved several times as far; then they wake and follow. The missed motion does
    // not accumulate.
    EXPECT_GT(wakings, 2);
    EXPECT_LT(most[0], 0.1f * drift * steps);
    EXPECT_LT(most[1], 1.25f * most[0]);
}

TEST_F(SleepTest, WokenBodyMatchesNeverSleepingBody) {
    SoftBody body = sleeping_cube();
    SoftBody awake = cube(false);
    for (int k = 0; k < 40; ++k) {
        touch_corner(body);
        step(body, pull(3e-3f));
        step(awake, pull(3e-3f));
    }
    EXPECT_GT(2 * body.sleep.awake_groups(), body.sleep.groups()) << "it has gone through the body";
    EXPECT_LT(apart(body, awake), sleep_settings.shift + sleep_settings.still);
    for (int k = 0; k < 400; ++k) {
        step(body);
        step(awake);
    }
    EXPECT_EQ(body.sleep.awake_groups(), 0u);
    EXPECT_LT(apart(body, awake), sleep_settings.shift + sleep_settings.still);
}

TEST_F(SleepTest, SameBitsForAnyNumberOfThreads) {
    const auto run = [](std::size_t threads) {
        return test::with_threads(threads, [] {
            SoftBody body = sleeping_cube();
            for (int k = 0; k < 60; ++k) {
                if (k < 20) {
                    touch_corner(body);
                }
                step(body, k < 20 ? pull(2e-3f) : Tool());
            }
            EXPECT_GT(body.sleep.awake_groups(), 0u);
            EXPECT_FALSE(body.sleep.all_awake());
            return body.particles.position;
        });
    };
    const std::vector<Vec3f> one = run(1);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(8), one);
}

TEST_F(SleepTest, LinkWakesItsOtherEnd) {
    SoftBody body = cube(false);
    const auto far = static_cast<std::uint32_t>(n - 1);  // the next corner
    body.links.configure({{0u, far}}, {100.0f}, body.particles);
    body.enable_sleeping({}, sleep_settings);
    rest(body);
    ASSERT_EQ(body.sleep.awake_groups(), 0u);
    for (int k = 0; k < 3; ++k) {
        touch_corner(body);
        step(body, pull(1e-3f));
    }
    EXPECT_GT(body.particles.mobility(far), 0.0f);
}

TEST_F(SleepTest, CreepingMeshStaysAwake) {
    SoftBody body = test::cluster_block(n, 8e3f, Vec3f::Zero(), 2);
    body.enable_sleeping(std::vector<bool>(body.particles.size(), true), sleep_settings);
    body.sleep.keep_mesh_awake(true);
    rest(body);
    EXPECT_TRUE(body.sleep.mesh_awake());
    EXPECT_EQ(body.sleep.awake_groups(), 1u);
    body.sleep.keep_mesh_awake(false);
    step(body);
    EXPECT_FALSE(body.sleep.mesh_awake());
}

TEST_F(SleepTest, SelfContactWakesNearbyParticles) {
    SoftBody body = sleeping_cube();
    constexpr std::uint32_t other = n * (n - 1);  // the corner along y
    body.particles.radius.assign(body.particles.size(), 0.5f * test::cluster_spacing * n);
    SelfContact contact;
    contact.configure({0u, other}, {}, {}, body.particles);
    touch_corner(body);
    SoftBody untouched = body;
    body.constraints.emplace_back(std::move(contact));
    step(untouched, pull(1e-3f));
    step(body, pull(1e-3f));
    EXPECT_EQ(untouched.particles.mobility(other), 0.0f);
    EXPECT_GT(body.particles.mobility(other), 0.0f);
}

}  // namespace
}  // namespace eti::pbd
