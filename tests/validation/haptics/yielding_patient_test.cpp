// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// A hand holds the blade in a patient whose jaw, hyoid and head yield to it, while an assistant moves head
// and jaw. Promised (docs/hands/forces.md): force and torque within the device's range and rate in every
// cycle, and no limit cycle.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <ostream>

#include "common/math/random.hpp"
#include "common/math/units.hpp"
#include "common/model/pace.hpp"
#include "devices/haptics/haptic_loop.hpp"
#include "devices/haptics/reports.hpp"
#include "server/app/output/scene_messages.hpp"
#include "server/scene/scene.hpp"
#include "tests/support/coarse_newborn.hpp"
#include "tests/validation/haptics/closed_loop.hpp"

namespace eti::validation {
namespace {

constexpr std::int64_t ns_per_ms = 1'000'000;
constexpr std::int64_t origin_ns = 1'000 * ns_per_ms;  // a time of 0 means that nothing has arrived

// [ms]: forces engage in front of the tongue, the blade presses it, turns, and is held while the assistant
// moves head and jaw; then all are still.
constexpr int presses = 700, turns = 1500, moves = 2200, rests = 3200, still = 3700,
              ends = still + Stillness::length_ms;

float ramp(int at_ms, int from, int to) {
    return std::clamp(static_cast<float>(at_ms - from) / static_cast<float>(to - from), 0.0f, 1.0f);
}

scene::Inputs start_inputs() {
    scene::Inputs in;
    in.tube_grip.translation = Vec3f(-0.12f, -0.25f, 0.10f);
    in.runtime_parameters.head_elevation = 20.0f * degree;
    in.runtime_parameters.jaw_opening = 30.0f * degree;
    return in;
}

/// The session behind a channel, in virtual time; messages are those of the bus.
class Session {
  public:
    Session(const Channel& channel, const Laryngoscope& scope, const RigidTransform& start)
        : channel_(channel), scene_(test::coarse_newborn(), scope, Tube{}, at(start), {}) {
        state_.blade = scope.capsules;
    }

    void hear(const RigidTransform& device, std::int64_t now) { up_.send(device, now, channel_, random_); }

    void advance(std::int64_t now, float head_elevation, float jaw_opening) {
        if (next_step_ <= now) {
            next_step_ += time_ns_of(1);
            (void)up_.receive(now, inputs_.laryngoscope);
            inputs_.runtime_parameters.head_elevation = head_elevation;
            inputs_.runtime_parameters.jaw_opening = jaw_opening;
            scene_.step(inputs_);
            forces_.assign(scene_.snapshot());
            proxies_.send(app::proxy_message(scene_.snapshot()), now, channel_, random_);
            tissues_.send(app::tissue_message(forces_), now, channel_, random_);
        }
        const bool proxy = proxies_.receive(now, proxy_), tissue = tissues_.receive(now, tissue_);
        if (proxy && devices::read_report(proxy_, state_.proxy)) {
            state_.proxy_arrived = now;
            state_.seen.time = 1e-9 * static_cast<double>(proxy_.header().simulation_time_ns());
        }
        if (tissue && devices::read_report(tissue_, state_.tissue)) {
            state_.tissue_arrived = now;
        }
        if (proxy || tissue) {
            newest.write(state_);
        }
    }
    [[nodiscard]] const scene::Scene& scene() const { return scene_; }

    Mailbox<devices::SceneState> newest;

  private:
    const scene::Inputs& at(const RigidTransform& pose) {
        inputs_ = start_inputs();
        inputs_.laryngoscope = pose;
        return inputs_;
    }

    Channel channel_;
    scene::Inputs inputs_;
    scene::Scene scene_;
    app::HandForces forces_;
    Random random_{1};
    Line<RigidTransform> up_;
    Line<msg::ProxyState> proxies_;
    Line<msg::TissueContacts> tissues_;
    msg::ProxyState proxy_;
    msg::TissueContacts tissue_;
    devices::SceneState state_;
    std::int64_t next_step_ = origin_ns;
};

/// Follows the plan in a firm grip.
class Hand final : public HeldDevice {
  public:
    Hand(Motors motors, const Laryngoscope& scope, const Vec3f& dorsum)
        : HeldDevice(motors, {}, pose_at(0, scope, dorsum)), scope_(scope), dorsum_(dorsum) {}

    /// [m]
    [[nodiscard]] Vec3f tip() const { return pose() * scope_.tip(); }
    [[nodiscard]] RigidTransform start() const { return pose_at(0, scope_, dorsum_); }

  private:
    [[nodiscard]] RigidTransform wanted() override { return pose_at(++at_ms_, scope_, dorsum_); }
    [[nodiscard]] static RigidTransform pose_at(int at_ms, const Laryngoscope& scope, const Vec3f& dorsum) {
        const Quatf turn(
            Eigen::AngleAxisf((-90.0f + 15.0f * ramp(at_ms, turns, moves)) * degree, Vec3f::UnitX()));
        const Vec3f tip = dorsum + Vec3f(0.0f, 0.0f, 6e-3f - 14e-3f * ramp(at_ms, presses, turns));
        return {turn, tip - turn * scope.tip()};
    }

    Laryngoscope scope_;
    Vec3f dorsum_;
    int at_ms_ = 0;
};

struct Case {
    Motors motors;
    Channel channel;
};
void PrintTo(const Case& c, std::ostream* out) {
    *out << (c.motors == Motors::six ? "six" : "three") << " motors, " << 1e3 * c.channel.delay << " ms, "
         << 100.0 * c.channel.loss << " % lost";
}

class YieldingPatient : public ::testing::TestWithParam<Case> {};

TEST_P(YieldingPatient, ForcesStayWithinThePromise) {
    const Laryngoscope scope = make_laryngoscope(Blade::miller_1);
    const Vec3f dorsum = [&] {
        scene::Inputs away = start_inputs();
        away.laryngoscope.translation = Vec3f(0.0f, -0.25f, 0.15f);
        return at(scene::Scene(test::coarse_newborn(), scope, Tube{}, away, {}).snapshot().landmarks,
                  Landmark::tongue_dorsum);
    }();
    devices::RenderSettings settings;
    if (GetParam().motors == Motors::three) {
        settings.torque = false;
        settings.gimbal = HeldDevice::gimbal;
        settings.coupling.torque_limit = 0.0f;
    }
    Hand hand(GetParam().motors, scope, dorsum);
    const auto session = std::make_unique<Session>(GetParam().channel, scope, hand.start());
    devices::HapticCycle cycle(hand, session->newest, settings);

    const CouplingSettings& device = settings.coupling;
    Wrench before;
    std::array<Stillness, 3> stillness;
    scene::YieldingSkeleton::Vector most = scene::YieldingSkeleton::Vector::Zero();
    float force = 0.0f;
    for (int ms = 0; ms < ends; ++ms) {
        const std::int64_t now = origin_ns + ms * ns_per_ms;
        const float moved = ramp(ms, moves, rests);
        session->advance(now, (20.0f + 8.0f * moved) * degree, (30.0f - 10.0f * moved) * degree);
        if (const auto pose = cycle.run(now)) {
            session->hear(pose->pose, now);
        }
        const Wrench& felt = cycle.wrench();
        ASSERT_TRUE(felt.is_finite()) << ms;
        ASSERT_LE(felt.force.norm(), device.force_limit * 1.0001f) << ms;
        ASSERT_LE(felt.torque.norm(), device.torque_limit * 1.0001f) << ms;
        ASSERT_LE((felt.force - before.force).norm(), 1e-3f * device.force_rate_limit * 1.01f) << ms;
        before = felt;
        most = most.cwiseMax(session->scene().skeleton()->offset().cwiseAbs());
        force = std::max(force, felt.force.norm());
        for (int axis = 0; axis < 3; ++axis) {
            stillness[static_cast<std::size_t>(axis)].add(ms - still, static_cast<double>(hand.tip()[axis]));
        }
    }
    for (const Stillness& axis : stillness) {
        EXPECT_LE(axis.excursion(), most_excursion);
    }
    EXPECT_GT(force, 1.0f) << "nothing was felt";
    // More than half a millimetre at the gums, a quarter at the hyoid.
    EXPECT_GT(most[scene::YieldingSkeleton::head_extension], 0.05f);
    EXPECT_GT(most[scene::YieldingSkeleton::jaw_opening], 0.02f);
    EXPECT_GT(most.tail<3>().norm(), 0.25e-3f);
}

// From the corners of the map of passivity (docs/hands/stability.md).
constexpr Channel channels[] = {
    {}, {.delay = 0.010, .jitter = 0.001, .loss = 0.01}, {.delay = 0.050, .jitter = 0.001, .loss = 0.05}};

INSTANTIATE_TEST_SUITE_P(Motors, YieldingPatient,
                         ::testing::Values(Case{Motors::six, channels[0]}, Case{Motors::six, channels[1]},
                                           Case{Motors::six, channels[2]}, Case{Motors::three, channels[0]},
                                           Case{Motors::three, channels[1]},
                                           Case{Motors::three, channels[2]}));

}  // namespace
}  // namespace eti::validation
