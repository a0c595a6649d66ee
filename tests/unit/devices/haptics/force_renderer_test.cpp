// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/force_renderer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "common/device/hand.hpp"
#include "common/math/random.hpp"

namespace eti::devices {
namespace {

constexpr float renderer_dt = 1e-3f;
constexpr std::int64_t ms_in_ns = 1'000'000;
// Cycles until a new force is reached: a message in every cycle restarts the smoothing over 5.6 ms, and 1 -
// 0.18 to this power is 1e-9.
constexpr int settled = 100;

Motion still(const Vec3f& at = Vec3f::Zero()) {
    return {{Quatf::Identity(), at}, Vec3f::Zero(), Vec3f::Zero()};
}

/// A renderer whose force is engaged and fully ramped up on a free device at rest.
class EngagedRenderer : public ::testing::Test {
  protected:
    void SetUp() override {
        for (int i = 0; i < 600; ++i) {
            ASSERT_LT(cycle().force.norm(), 1e-6f);
        }
    }

    /// Advances by a millisecond; a server message arrives unless `silent`.
    Wrench cycle(bool silent = false) {
        now_ += ms_in_ns;
        if (!silent) {
            scene_.proxy_arrived = scene_.tissue_arrived = now_;
        }
        return renderer_.cycle(device_, scene_, now_, renderer_dt);
    }
    /// Advances by that many cycles, each with a message; returns the last force.
    Wrench advance(int count) {
        Wrench wrench;
        for (int i = 0; i < count; ++i) {
            wrench = cycle();
        }
        return wrench;
    }

    RenderSettings settings_;
    ForceRenderer renderer_{settings_};
    SceneState scene_;
    Motion device_ = still();
    std::int64_t now_ = 1'000 * ms_in_ns;
};

TEST_F(EngagedRenderer, TheCouplingsSpringIsFelt) {
    // 2 mm above the device, held there by a floor: 800 N/m * 2 mm = 1.6 N up.
    scene_.proxy.proxy.pose.translation = {0, 2e-3f, 0};
    scene_.proxy.normals[0] = Vec3f::UnitY();
    scene_.proxy.contacts = 1;
    const Wrench wrench = advance(20);
    EXPECT_LT((wrench.force - Vec3f(0, 1.6f, 0)).norm(), 1e-5f);
}

TEST_F(EngagedRenderer, TheTissuesForceIsFeltInNewtons) {
    scene_.tissue.wrench = {{1.0f, 0.5f, 0}, {0, 0.02f, 0}};
    const Wrench wrench = advance(settled);
    EXPECT_LT((wrench.force - Vec3f(1.0f, 0.5f, 0)).norm(), 1e-6f);
    EXPECT_LT((wrench.torque - Vec3f(0, 0.02f, 0)).norm(), 1e-7f);
}

TEST_F(EngagedRenderer, RendersOnlyTheSelectedSoftForce) {
    settings_.soft_force = SoftForce::displacement;
    ForceRenderer displacement(settings_);
    scene_.blade[0] = {{0, 0, 0}, {0, 0, 0.1f}, 4e-3f};
    scene_.tissue.points[0] = {{0, 0, 0.05f}, {0, 1e-3f, 0.05f}, 1e-3f, Tissue::tongue};
    scene_.tissue.count = 1;
    scene_.tissue.wrench.force = {3, 0, 0};
    scene_.proxy_arrived = scene_.tissue_arrived = now_;
    // A device that starts in contact is not quiet; start it clear of the tissue.
    SceneState clear = scene_;
    clear.tissue = {};
    for (int i = 0; i < 600; ++i) {
        (void)displacement.cycle(device_, clear, now_, renderer_dt);
    }
    Wrench wrench;
    for (int i = 0; i < settled; ++i) {
        wrench = displacement.cycle(device_, scene_, now_, renderer_dt);
    }
    EXPECT_LT((wrench.force - Vec3f(0, 1e-3f * tissue_stiffness()[1], 0)).norm(), 1e-6f);
}

TEST_F(EngagedRenderer, NothingExceedsTheDevicesRangeOrRate) {
    Random random(5);
    Wrench last = cycle();
    for (int i = 0; i < 3000; ++i) {
        scene_.tissue.wrench.force = 40.0f * Vec3f(random.normal(), random.normal(), random.normal());
        scene_.tissue.wrench.torque = 2.0f * Vec3f(random.normal(), random.normal(), random.normal());
        const Wrench wrench = cycle();
        const CouplingSettings& limits = settings_.coupling;
        ASSERT_LE(wrench.force.norm(), limits.force_limit * 1.0001f);
        ASSERT_LE(wrench.torque.norm(), limits.torque_limit * 1.0001f);
        ASSERT_LE((wrench.force - last.force).norm(), limits.force_rate_limit * renderer_dt * 1.001f);
        last = wrench;
    }
}

TEST_F(EngagedRenderer, NonFiniteForceDisengagesImmediately) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        SetUp();
        scene_.tissue.wrench.force = {2.0f, 0, 0};
        advance(settled);
        ASSERT_GT(cycle().force.norm(), 1.9f);
        const auto before = renderer_.not_finite();
        scene_.tissue.wrench.force.y() = bad;
        EXPECT_EQ(cycle().force.norm(), 0.0f);
        EXPECT_EQ(renderer_.not_finite(), before + 1);
        scene_.tissue.wrench.force.y() = 0.0f;
        for (int i = 0; i < 100; ++i) {
            ASSERT_EQ(cycle().force.norm(), 0.0f) << "it came back without a quiet device";
        }
        scene_.tissue.wrench.force = Vec3f::Zero();
        advance(settled);
    }
}

TEST_F(EngagedRenderer, LateCycleDoesNotExceedRateLimit) {
    const float most = settings_.coupling.force_rate_limit * settings_.safety.longest_cycle;
    scene_.tissue.wrench.force = {5.0f, 0, 0};
    now_ += 15 * ms_in_ns;
    scene_.proxy_arrived = scene_.tissue_arrived = now_;
    EXPECT_LE(renderer_.cycle(device_, scene_, now_, 15e-3f).force.norm(), 1.001f * most);
}

TEST_F(EngagedRenderer, StalledLoopRestartsWithTheRamp) {
    scene_.tissue.wrench.force = {5.0f, 0, 0};
    advance(settled);
    ASSERT_GT(cycle().force.norm(), 4.9f);
    now_ += 500 * ms_in_ns;
    scene_.proxy_arrived = scene_.tissue_arrived = now_;
    EXPECT_EQ(renderer_.cycle(device_, scene_, now_, 0.5f).force.norm(), 0.0f);
    for (int i = 0; i < 100; ++i) {
        EXPECT_LE(cycle().force.norm(),
                  5.01f * static_cast<float>(i + 1) * renderer_dt / settings_.safety.return_time)
            << i;
    }
    advance(600);
    EXPECT_GT(cycle().force.norm(), 4.9f);
}

TEST_F(EngagedRenderer, MessageNewerThanTheCycleIsFresh) {
    scene_.tissue.wrench.force = {2.0f, 0, 0};
    advance(settled);
    now_ += ms_in_ns;
    scene_.proxy_arrived = scene_.tissue_arrived = now_ + 1000;
    EXPECT_GT(renderer_.cycle(device_, scene_, now_, renderer_dt).force.norm(), 1.9f);
    EXPECT_FALSE(renderer_.stale());
}

TEST_F(EngagedRenderer, TorqueCountsAsNotQuiet) {
    ForceRenderer waking(settings_);
    scene_.tissue.wrench.torque = {0, 0.1f, 0};
    for (int i = 0; i < 1000; ++i) {
        now_ += ms_in_ns;
        scene_.proxy_arrived = scene_.tissue_arrived = now_;
        ASSERT_EQ(waking.cycle(device_, scene_, now_, renderer_dt).torque.norm(), 0.0f) << i;
    }
}

TEST_F(EngagedRenderer, SilenceHoldsTheForceThenFadesItBy300ms) {
    scene_.tissue.wrench.force = {settings_.coupling.force_limit, 0, 0};
    advance(50);
    Wrench last = cycle();
    const float all = settings_.coupling.force_limit;
    ASSERT_NEAR(last.force.norm(), all, 1e-3f);
    for (int silent_ms = 1; silent_ms <= 400; ++silent_ms) {
        const Wrench wrench = cycle(true);
        // 200 ms of fade, to float rounding of the age.
        EXPECT_LE((wrench.force - last.force).norm(), 1.01f * all / 200.0f) << silent_ms;
        EXPECT_EQ(renderer_.stale(), silent_ms > 100) << silent_ms;
        if (silent_ms <= 100) {
            EXPECT_GT(wrench.force.norm(), 0.999f * all) << silent_ms;
        }
        if (silent_ms >= 301) {
            EXPECT_EQ(wrench.force.norm(), 0.0f) << silent_ms;
        }
        last = wrench;
    }
    // It is back within 0.3 s, without a jolt.
    const float steepest = all * renderer_dt / settings_.safety.return_time;
    for (int i = 0; i < 300; ++i) {
        const Wrench wrench = cycle();
        ASSERT_LE((wrench.force - last.force).norm(), 1.01f * steepest) << i;
        last = wrench;
    }
    EXPECT_GT(last.force.norm(), 0.999f * all);
    EXPECT_FALSE(renderer_.stale());
}

TEST_F(EngagedRenderer, PartialFadeRecoversFromRemainingForce) {
    scene_.tissue.wrench.force = {4.0f, 0, 0};
    for (int i = 0; i < 200; ++i) {
        (void)cycle(i >= 50);
    }
    const float left = cycle(true).force.norm();
    ASSERT_NEAR(left, 3.0f, 0.1f) << "a quarter of the fade";
    float force = cycle().force.norm();
    EXPECT_NEAR(force, left, 0.1f);
    for (int i = 0; i < 100; ++i) {
        force = cycle().force.norm();
    }
    EXPECT_NEAR(force, 4.0f, 1e-4f) << "a newton takes a quarter of the time that all four would";
}

/// The device 2 mm in a floor; then no messages.
class RendererOnFloor : public EngagedRenderer {
  protected:
    void SetUp() override {
        EngagedRenderer::SetUp();
        scene_.proxy.proxy.pose.translation = {0, 2e-3f, 0};
        scene_.proxy.normals[0] = Vec3f::UnitY();
        scene_.proxy.contacts = 1;
        advance(20);
        ASSERT_NEAR(cycle().force.y(), 1.6f, 1e-4f);
    }
    float silent(float y, int cycles) {
        device_ = still({0, y, 0});
        float force = 0.0f;
        for (int i = 0; i < cycles; ++i) {
            force = cycle(true).force.y();
        }
        return force;
    }
};

TEST_F(RendererOnFloor, FloorPersistsThroughAGapAndNeverPulls) {
    EXPECT_NEAR(silent(0.0f, 40), 1.6f, 1e-4f);
    EXPECT_NEAR(silent(-1e-3f, 10), 2.4f, 1e-4f);
    EXPECT_NEAR(silent(1.5e-3f, 10), 0.4f, 1e-4f);
    EXPECT_NEAR(silent(5e-3f, 10), 0.0f, 1e-6f);
    EXPECT_NEAR(silent(1e-3f, 10), 0.8f, 1e-4f);
    EXPECT_FALSE(renderer_.stale());
}

// The posture changed meanwhile: the floor has come 4 mm nearer, 3.2 N more, over 0.1 s.
TEST_F(RendererOnFloor, ProxyMovedDuringAGapRampsIn) {
    float last = silent(0.0f, 60);
    scene_.proxy.proxy.pose.translation.y() = 6e-3f;
    const float most = settings_.coupling.force_limit * renderer_dt / settings_.safety.return_time;
    int cycles = 0;
    for (; last < 4.799f && cycles < 1000; ++cycles) {
        const float now = cycle().force.y();
        ASSERT_LE(now - last, 1.01f * most) << cycles;
        ASSERT_GE(now, last - 1e-5f) << "what was there stays";
        last = now;
    }
    EXPECT_NEAR(cycles, 3.2f / most, 3);
}

TEST_F(RendererOnFloor, RemovedFloorIsReleasedAtRateLimit) {
    (void)silent(0.0f, 60);
    scene_.proxy.contacts = 0;
    scene_.proxy.proxy.pose.translation.y() = 0.0f;
    advance(3);
    EXPECT_EQ(cycle().force.norm(), 0.0f);
}

TEST_F(RendererOnFloor, RefusedMessageZeroesForceImmediately) {
    EXPECT_GT(silent(0.0f, 60), 1.59f);
    scene_.proxy_arrived = 0;  // as SceneLink leaves it
    now_ += ms_in_ns;
    EXPECT_EQ(renderer_.cycle(device_, scene_, now_, renderer_dt).force.norm(), 0.0f);
}

TEST_F(RendererOnFloor, NonFiniteDevicePoseZeroesForceImmediately) {
    EXPECT_GT(silent(0.0f, 60), 1.59f);
    device_.pose.translation.x() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(cycle(true).force.norm(), 0.0f);
}

// Into a wall not reported before: 4 mm deep when the message arrives.
TEST_F(EngagedRenderer, ContactMadeDuringAGapRampsIn) {
    for (int i = 0; i < 80; ++i) {
        EXPECT_LT(cycle(true).force.norm(), 1e-6f);
    }
    scene_.proxy.proxy.pose.translation = {0, 4e-3f, 0};
    scene_.proxy.normals[0] = Vec3f::UnitY();
    scene_.proxy.contacts = 1;
    scene_.tissue.wrench.force = {0, 1.0f, 0};
    const float most = settings_.coupling.force_limit * renderer_dt / settings_.safety.return_time;
    float last = 0.0f;
    for (int i = 0; i < 300; ++i) {
        const float now = cycle().force.norm();
        ASSERT_LE(now - last, 1.01f * most) << i;
        last = now;
    }
    EXPECT_NEAR(last, 4.2f, 1e-3f);
}

// A new message every 5.6 ms that alternates by 1 N: the force follows within a message, and no cycle carries
// more than its share of the step.
TEST_F(EngagedRenderer, ServerUpdatesCauseNoForceSteps) {
    scene_.tissue.wrench.force = {2.0f, 0, 0};
    advance(50);
    Wrench last = cycle();
    float most = 0.0f;
    for (int i = 0; i < 600; ++i) {
        now_ += ms_in_ns;
        scene_.proxy_arrived = now_;
        if (i % 6 == 0) {
            scene_.tissue_arrived = now_;
            scene_.tissue.wrench.force.x() = i % 12 == 0 ? 1.0f : 2.0f;
        }
        const Wrench wrench = renderer_.cycle(device_, scene_, now_, renderer_dt);
        most = std::max(most, (wrench.force - last.force).norm());
        if (i % 6 == 5) {
            EXPECT_NEAR(wrench.force.x(), scene_.tissue.wrench.force.x(), 1e-5f);
        }
        last = wrench;
    }
    EXPECT_LE(most, 1.0f * renderer_dt * 180.0f * 1.01f);
    EXPECT_GE(most, 0.15f);
}

TEST_F(EngagedRenderer, ReleaseRequiresQuietBeforeTheRamp) {
    scene_.tissue.wrench.force = {3.0f, 0, 0};
    advance(50);
    renderer_.release();
    for (int i = 0; i < 200; ++i) {
        ASSERT_EQ(cycle().force.norm(), 0.0f);
    }
    scene_.tissue.wrench.force = Vec3f::Zero();
    advance(60);
    scene_.tissue.wrench.force = {3.0f, 0, 0};
    EXPECT_LT(cycle().force.norm(), 1.0f);
}

// Forces that return under a pressing hand push it out; this is no oscillation that passivity control should
// damp.
TEST_F(EngagedRenderer, PassivityDoesNotOpposeTheRamp) {
    scene_.tissue.wrench.force = {5.0f, 0, 0};
    renderer_.release();
    scene_.tissue.wrench.force = Vec3f::Zero();
    advance(100);
    scene_.tissue.wrench.force = {5.0f, 0, 0};
    for (int i = 0; i < 200; ++i) {
        device_.velocity = {0.01f, 0, 0};
        device_.pose.translation.x() += 0.01f * renderer_dt;
        (void)cycle();
    }
    // Some 2 N over a cycle's 0.01 mm.
    EXPECT_LT(renderer_.passivity().lowest(), -5e-6) << "it gave nothing";
    EXPECT_EQ(renderer_.passivity().stored(), 0.0);
    EXPECT_EQ(renderer_.passivity().active_cycles(), 0u);
}

TEST_F(EngagedRenderer, TubeRendersOnlyItsOwnForce) {
    settings_.tool = Tool::tube;
    renderer_ = ForceRenderer(settings_);
    SetUp();
    scene_.proxy.proxy.pose.translation = {0, 5e-3f, 0};  // of the blade: irrelevant for the tube
    scene_.proxy.device.translation = {1, 1, 1};
    scene_.tissue.wrench = {{0, 0, -0.8f}, {0.01f, 0, 0}};
    const Wrench wrench = advance(settled);
    EXPECT_LT((wrench.force - Vec3f(0, 0, -0.8f)).norm(), 1e-6f);
    EXPECT_LT((wrench.torque - Vec3f(0.01f, 0, 0)).norm(), 1e-7f);
}

// The blade's contacts apply no torque to the tube.
TEST_F(EngagedRenderer, TubeForceIgnoresBladeContact) {
    settings_.tool = Tool::tube;
    settings_.torque = false;
    renderer_ = ForceRenderer(settings_);
    SetUp();
    scene_.proxy.contacts = 1;
    scene_.proxy.normals[0] = Vec3f::UnitY();
    scene_.proxy.contact_centre = {0, 0.03f, 0};
    scene_.tissue.wrench = {{0, 0, -0.8f}, {0.05f, 0, 0}};
    const Wrench wrench = advance(settled);
    EXPECT_LT((wrench.force - Vec3f(0, 0, -0.8f)).norm(), 1e-6f);
    EXPECT_EQ(wrench.torque.norm(), 0.0f);
}

// 2 N along z at a gimbal 60 mm from the tool's origin, about which the tool turns by 0.2 rad: the gimbal
// moves 0.06 m * sin 0.2 along the force.
TEST_F(EngagedRenderer, WithoutTorqueEnergyIsTakenAtTheGimbal) {
    settings_.torque = false;
    settings_.gimbal = {0, 0.06f, 0};
    settings_.passivity.on = false;
    renderer_ = ForceRenderer(settings_);
    SetUp();
    scene_.tissue.wrench.force = {0, 0, 2.0f};
    advance(settled);
    const double before = renderer_.passivity().stored();
    for (int i = 1; i <= 200; ++i) {
        device_.pose.rotation = quaternion_from({1e-3f * static_cast<float>(i), 0, 0});
        scene_.proxy.proxy.pose.rotation = scene_.proxy.device.rotation = device_.pose.rotation;
        (void)cycle();
    }
    EXPECT_NEAR(renderer_.passivity().stored() - before, -2.0 * 0.06 * std::sin(0.2), 2e-4);
}

// The blade is levered on a gum at the origin: the shell turns the proxy back by 0.1 rad, 0.15 N m. Without
// torque, the gimbal 60 mm up the handle pulls with 0.15 / 0.06 = 2.5 N perpendicular to its arm.
TEST_F(EngagedRenderer, WithoutTorqueTheGumIsFeltAtTheGimbal) {
    settings_.torque = false;
    settings_.gimbal = {0, 0.06f, 0};
    settings_.coupling.torque_limit = 0.0f;
    renderer_ = ForceRenderer(settings_);
    SetUp();
    scene_.proxy.proxy.pose.rotation = quaternion_from({0.1f, 0, 0});
    scene_.proxy.normals[0] = Vec3f::UnitY();
    scene_.proxy.contacts = 1;
    const Wrench wrench = advance(40);
    EXPECT_LT((wrench.force - Vec3f(0, 0, 2.5f)).norm(), 0.01f) << wrench.force;
    EXPECT_EQ(wrench.torque.norm(), 0.0f);
}

// A tongue presses the tip with 6 N, and the gum is touched in every other message with next to no load: with
// the whole lever at each touch, the force turned around in every message, and 6 N came within 10 ms.
TEST_F(EngagedRenderer, WithoutTorqueLightTouchesAreNotFelt) {
    settings_.torque = false;
    settings_.gimbal = {0, 0.06f, 0};
    settings_.passivity.on = false;
    renderer_ = ForceRenderer(settings_);
    SetUp();
    scene_.tissue.wrench.force = {0, 0, 6.0f};
    scene_.proxy.normals[0] = Vec3f::UnitZ();
    scene_.proxy.contact_centre = {0, 0.03f, 0};
    Vec3f last = Vec3f::Zero();
    for (int i = 0; i < settled + 200; ++i) {
        scene_.proxy.contacts = i / 5 % 2 == 0 ? 1 : 0;
        scene_.proxy.proxy.pose.translation = {0, 0, scene_.proxy.contacts > 0 ? 1e-5f : 0.0f};
        const Vec3f force = cycle().force;
        if (i >= settled) {
            // 10 um of the coupling's 800 N/m, at most twice.
            EXPECT_LT((force - last).norm(), 2.0f * 800.0f * 1e-5f + 1e-3f) << i;
            EXPECT_GT(force.z(), 5.9f);
        }
        last = force;
    }
}

TEST_F(EngagedRenderer, SilentTissueFadesIndependently) {
    scene_.tissue.wrench.force = {2.0f, 0, 0};
    scene_.proxy.proxy.pose.translation = {0, 2e-3f, 0};
    scene_.proxy.normals[0] = Vec3f::UnitY();
    scene_.proxy.contacts = 1;
    Wrench wrench;
    for (int i = 0; i < 320; ++i) {
        now_ += ms_in_ns;
        scene_.proxy_arrived = now_;
        wrench = renderer_.cycle(device_, scene_, now_, renderer_dt);
        if (i == 90) {
            EXPECT_NEAR(wrench.force.x(), 2.0f, 1e-3f) << "held";
        }
    }
    EXPECT_LT((wrench.force - Vec3f(0, 1.6f, 0)).norm(), 1e-4f);
    // It returns by the ramp.
    EXPECT_LT(cycle().force.x(), 0.1f);
    for (int i = 0; i < 200; ++i) {
        wrench = cycle();
    }
    EXPECT_NEAR(wrench.force.x(), 2.0f, 1e-3f);
}

TEST(ForceRenderer, WithoutASceneForceIsZero) {
    ForceRenderer renderer({});
    for (int i = 1; i < 1000; ++i) {
        ASSERT_EQ(renderer.cycle(still({0.1f, 0, 0}), {}, i * ms_in_ns, renderer_dt).force.norm(), 0.0f);
    }
}

TEST(ForceRenderer, StartingInContactGivesNoForce) {
    ForceRenderer renderer({});
    SceneState scene;
    scene.proxy.proxy.pose.translation = {0, 4e-3f, 0};
    scene.proxy.normals[0] = Vec3f::UnitY();
    scene.proxy.contacts = 1;
    for (int i = 1; i < 2000; ++i) {
        scene.proxy_arrived = i * ms_in_ns;
        ASSERT_EQ(renderer.cycle(still(), scene, i * ms_in_ns, renderer_dt).force.norm(), 0.0f);
    }
}

/// A server that latches the device's pose every 1/180 s and reports its proxy `latency` later, like the real
/// one for a proxy without contact. The proxy is near the latched pose, trailing by up to a measured 0.6 of
/// the step's motion, with the velocity between the last two poses. Latching, computing and sending jitter by
/// up to 2 ms.
struct FreeServer {
    struct Sent {
        std::int64_t arrives;
        ProxyReport report;
    };
    std::int64_t latency, next = 0;
    std::deque<Sent> on_the_way;
    Vec3f last = Vec3f::Zero();
    Random random{9};

    void run(const RigidTransform& device, std::int64_t now, SceneState& scene) {
        if (now >= next) {
            next = now + 1'000'000'000 / 180;
            ProxyReport report;
            report.device = report.proxy.pose = device;
            report.proxy.velocity = 180.0f * (device.translation - last);
            report.proxy.pose.translation -= 0.6f * random.uniform() * (device.translation - last);
            last = device.translation;
            on_the_way.push_back(
                {now + latency + static_cast<std::int64_t>(random.uniform() * 2e6f), report});
        }
        while (!on_the_way.empty() && on_the_way.front().arrives <= now) {
            scene.proxy = on_the_way.front().report;
            scene.proxy_arrived = on_the_way.front().arrives;
            on_the_way.pop_front();
        }
    }
};

class FreeHand : public ::testing::TestWithParam<int> {};

// A hand that moves freely at 0.2 m/s feels less than 0.1 N at any latency within the stale limit. The proxy
// as reported would pull it with 0.2 m/s * (latency + 5.6 ms) * 800 N/m.
TEST_P(FreeHand, FeelsAlmostNothing) {
    const std::int64_t latency = GetParam() * ms_in_ns;
    const RenderSettings settings;
    ForceRenderer renderer(settings);
    FreeServer server{.latency = latency, .on_the_way = {}};
    SceneState scene;
    const HandSettings hand;
    float most = 0.0f, as_reported = 0.0f;
    for (int i = 0; i < 3000; ++i) {
        const std::int64_t now = 1'000 * ms_in_ns + i * ms_in_ns;
        const float t = static_cast<float>(i) * renderer_dt;
        Motion device = still(Vec3f(0.2f * t, 0.05f, 0.0f));
        device.velocity = {0.2f, 0, 0};
        device.pose.translation =
            (device.pose.translation / hand.encoder_step).array().round() * hand.encoder_step;
        server.run(device.pose, now, scene);
        most = std::max(most, renderer.cycle(device, scene, now, renderer_dt).force.norm());
        if (i > 1000) {
            ASSERT_TRUE(renderer.engaged());
            as_reported = std::max(
                as_reported, coupling_wrench(device, scene.proxy.proxy, settings.coupling).force.norm());
        }
    }
    EXPECT_LT(most, 0.1f);
    EXPECT_GT(as_reported, 0.2f * (5e-3f + static_cast<float>(GetParam()) * 1e-3f) * 800.0f - 0.4f)
        << "the server of this test does not lag, so the test shows nothing";
}

INSTANTIATE_TEST_SUITE_P(LatencyMs, FreeHand, ::testing::Values(1, 5, 12));

}  // namespace
}  // namespace eti::devices
