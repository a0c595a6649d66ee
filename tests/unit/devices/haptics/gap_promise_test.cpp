// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Stand-in devices with three and with six motors, held still or rotating, log the force of every cycle of
// the haptic loop while messages are missing and come back. Promised (docs/decisions/haptic-forces.md): force
// and torque within the device's range and rate in every cycle, and after a gap no faster growth than the
// range within a quarter of a second, in no direction that the hand would not feel without the gap.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "common/model/pace.hpp"
#include "devices/haptics/haptic_loop.hpp"

namespace eti::devices {
namespace {

constexpr std::int64_t ns_per_ms = 1'000'000;
constexpr int quiet = 800, engaged = 1600;  // [ms]: forces engage in free air, then contact becomes steady
constexpr int watched = 700;                // [ms] after a gap; the return takes 250
constexpr int window = 10;                  // [ms] over which growth is measured

enum class Gum {
    none,     ///< only tissue presses
    borne,    ///< the blade is levered on the gum
    lost,     ///< levered until the middle of the gap
    found,    ///< levered from the middle of the gap on
    touched,  ///< in every other message, with next to no load
};
constexpr const char* gum_names[] = {"none", "borne", "lost", "found", "touched"};

struct Case {
    int gap_ms;
    Gum gum;
    bool six_motors, rotates;
    SoftForce law;
    [[nodiscard]] std::string name() const {
        return std::to_string(gap_ms) + "ms_" + gum_names[static_cast<int>(gum)] +
               (six_motors ? "_six" : "_three") + (rotates ? "_rotating" : "_still") +
               (law == SoftForce::constraint ? "_constraint" : "_displacement");
    }
};

/// Pose of the hand, whatever the force: 0.12 rad at 0.5 Hz, which is 0.4 rad/s.
Motion hand(bool rotates, int at_ms) {
    constexpr float amplitude = 0.12f, omega = std::numbers::pi_v<float>;
    const float phase = omega * 1e-3f * static_cast<float>(at_ms);
    Motion motion;
    motion.angular_velocity = motion.velocity = Vec3f::Zero();
    if (rotates) {
        motion.pose.rotation = quaternion_from({amplitude * std::sin(phase), 0, 0});
        motion.angular_velocity = {amplitude * omega * std::cos(phase), 0, 0};
    }
    return motion;
}

/// Moves as hand(), and logs what its motors get.
class LoggedDevice final : public Sensor {
  public:
    explicit LoggedDevice(bool rotates) : rotates_(rotates) {}
    Reading exchange(const Wrench& wrench, float) override {
        log.push_back(wrench);
        Reading reading;
        reading.motion = hand(rotates_, static_cast<int>(log.size()));
        reading.sample = log.size();
        return reading;
    }
    std::vector<Wrench> log;  // one per millisecond; the first before the first cycle

  private:
    bool rotates_;
};

/// Message number `number`, of the scene at `at_ms`.
SceneState scene_at(const Case& c, Gum gum, int at_ms, int number) {
    SceneState scene;
    scene.blade[0] = {{0, 0, 0}, {0, 0, 0.1f}, 4e-3f};
    const Motion device = hand(c.rotates, at_ms);
    scene.proxy.device = device.pose;
    scene.proxy.proxy = device;
    if (at_ms < quiet) {
        return scene;
    }
    // A tongue presses the tip 40 mm beyond the gum, with 5 N.
    scene.tissue.proxy = device.pose;
    scene.tissue.count = 50;
    for (std::size_t i = 0; i < scene.tissue.count; ++i) {
        const float z = 0.06f + 4e-4f * static_cast<float>(i);
        scene.tissue.points[i] = {device.pose * Vec3f(0, -4e-3f, z), device.pose * Vec3f(0, 4e-3f, z), 1e-3f,
                                  Tissue::tongue, device.pose.rotation * Vec3f(0, 0.1f, 0)};
        const Vec3f arm = scene.tissue.points[i].position - device.pose.translation;
        scene.tissue.wrench.force += scene.tissue.points[i].force;
        scene.tissue.wrench.torque += arm.cross(scene.tissue.points[i].force);
    }
    const bool levered = gum == Gum::borne, touches = gum == Gum::touched && number % 2 == 0;
    if (levered || touches) {
        scene.proxy.contacts = 1;
        scene.proxy.normals[0] = Vec3f::UnitY();
        scene.proxy.contact_centre = {0, 0, 0.03f};
        scene.proxy.proxy.pose.translation += Vec3f(0, levered ? 1.5e-3f : 1e-5f, 0);
    }
    return scene;
}

/// What the gum does at a time; `changes_ms`: when contact is lost or found.
Gum gum_at(Gum gum, int at_ms, int changes_ms) {
    switch (gum) {
        case Gum::lost:
            return at_ms < changes_ms ? Gum::borne : Gum::none;
        case Gum::found:
            return at_ms < changes_ms ? Gum::none : Gum::borne;
        default:
            return gum;
    }
}

/// Wrenches per millisecond. Without a `gap`, contact has always been as it is at the end. `controlled`: with
/// the passivity controller, whose damping comes and goes with the energy of a hand that no force moves.
std::vector<Wrench> felt(const Case& c, bool gap, bool controlled) {
    RenderSettings settings;
    settings.passivity.on = controlled;
    settings.torque = c.six_motors;
    settings.gimbal = {0, 0.06f, 0};
    settings.soft_force = c.law;
    LoggedDevice device(c.rotates);
    const auto newest = std::make_unique<Mailbox<SceneState>>();
    HapticCycle cycle(device, *newest, settings);
    const int resumed = engaged + c.gap_ms;
    double next_message = 0.0;
    int number = 0;
    for (int at = 1; at < resumed + watched; ++at) {
        if (static_cast<double>(at) >= next_message) {
            next_message += 1e3 / steps_per_second;
            ++number;
            if (!gap || at < engaged || at >= resumed) {
                const int changes = gap ? engaged + c.gap_ms / 2 : 0;
                SceneState scene = scene_at(c, gum_at(c.gum, at, changes), at, number);
                scene.proxy_arrived = scene.tissue_arrived = 1'000 * ns_per_ms + at * ns_per_ms;
                scene.seen.time = 1e-3 * at;
                newest->write(scene);
            }
        }
        (void)cycle.run(1'000 * ns_per_ms + at * ns_per_ms);
    }
    return device.log;
}

class GapPromise : public ::testing::TestWithParam<Case> {};

TEST_P(GapPromise, HoldsInEveryCycle) {
    const Case& c = GetParam();
    const CouplingSettings limits;
    const SafetySettings safety;
    for (const bool controlled : {false, true}) {
        const std::vector<Wrench> all = felt(c, true, controlled);
        for (std::size_t i = 1; i < all.size(); ++i) {
            ASSERT_LE(all[i].force.norm(), limits.force_limit * 1.0001f) << i << " ms";
            ASSERT_LE(all[i].torque.norm(), c.six_motors ? limits.torque_limit * 1.0001f : 0.0f)
                << i << " ms";
            ASSERT_LE((all[i].force - all[i - 1].force).norm(), limits.force_rate_limit * 1e-3f * 1.001f)
                << i << " ms";
        }
    }
    const std::vector<Wrench> log = felt(c, true, false), undisturbed = felt(c, false, false);
    ASSERT_EQ(log.size(), undisturbed.size());
    const auto resumed = static_cast<std::size_t>(engaged + c.gap_ms);
    ASSERT_GT(log[engaged - 1].force.norm(), 1.0f) << "nothing was felt before the gap";
    ASSERT_GT(log.back().force.norm(), 1.0f) << "nothing is felt after the gap";

    // The hand's own motion changes the force without a gap, too: between two messages by what it moves
    // against the tissue, which the next message, not expecting it, takes back. After a gap that is not taken
    // back but counts as exerted, so that the changes of single cycles add up.
    float moving = 0.0f;
    for (std::size_t i = resumed; i + 1 < undisturbed.size(); ++i) {
        moving = std::max(moving, window * (undisturbed[i + 1].force - undisturbed[i].force).norm());
    }
    ASSERT_LT(moving, 0.3f) << "the hand moves too fast for the ramp to be seen";
    // Both add as vectors, whose directions the hand's rotation of up to 0.12 rad changes: by 1 - cos 0.12.
    constexpr float turned = 1.008f;
    const float ramp = limits.force_limit * 1e-3f * window / safety.return_time;
    for (std::size_t i = resumed - window; i + window < log.size(); ++i) {
        EXPECT_LE(log[i + window].force.norm() - log[i].force.norm(), (ramp + moving) * turned)
            << i << " ms, gap ended at " << resumed;
        // Never against what is felt without a gap.
        const Vec3f direction = undisturbed[i].force.normalized();
        EXPECT_GE(log[i].force.dot(direction), -0.1f) << i << " ms: " << log[i].force.transpose();
        if (HasFailure()) {
            return;
        }
    }
    // The whole force is back.
    EXPECT_LT((log.back().force - undisturbed.back().force).norm(), 0.1f)
        << log.back().force.transpose() << " instead of " << undisturbed.back().force.transpose();
}

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    for (const int gap_ms : {50, 150, 300, 500, 1000, 3000}) {
        for (const Gum gum : {Gum::none, Gum::borne, Gum::lost, Gum::found, Gum::touched}) {
            for (const bool six : {false, true}) {
                for (const bool rotates : {false, true}) {
                    for (const SoftForce law : {SoftForce::constraint, SoftForce::displacement}) {
                        cases.push_back({gap_ms, gum, six, rotates, law});
                    }
                }
            }
        }
    }
    return cases;
}

INSTANTIATE_TEST_SUITE_P(Devices, GapPromise, ::testing::ValuesIn(all_cases()),
                         [](const auto& one) { return one.param.name(); });

}  // namespace
}  // namespace eti::devices
