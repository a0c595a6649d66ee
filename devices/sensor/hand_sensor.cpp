// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/hand_sensor.hpp"

#include <algorithm>

namespace eti::devices {

namespace {

// Bounds on the speed of the wanted pose after jumps: a new session, or a period without messages. Tracks
// stay far below: hands reach about 1 m/s, scripts move at 0.1 m/s.
constexpr float max_speed = 1.0f;  // [m/s]
constexpr float max_turn = 6.0f;   // [rad/s]
// A simulation time this far before the last one belongs to another session.
constexpr double session_gap = 0.5;         // [s]
constexpr float longest_step = 1e-3f;       // [s], of the simulated device
constexpr float longest_catch_up = 20e-3f;  // [s], after a late cycle; beyond it the device stands still

std::optional<TrackPlayer> player_of(const SensorSetup& setup) {
    if (!setup.script) {
        return std::nullopt;
    }
    return TrackPlayer(*setup.script, setup.tool, setup.tool_length, setup.curvature, setup.script->seed);
}

RigidTransform first_pose(std::optional<TrackPlayer>& player, const SensorSetup& setup) {
    return player ? player->wanted(setup.start) : parked_pose(setup.tool);
}

}  // namespace

HandSensor::HandSensor(const SensorSetup& setup)
    : at_start_(player_of(setup)),
      player_(at_start_),
      last_time_(setup.start.time),
      goal_(first_pose(player_, setup)),
      wanted_(goal_),
      hand_(HandSettings{}, goal_) {}

DeviceCapabilities HandSensor::capabilities() const {
    const CouplingSettings range;
    return {.force = range.force_limit, .torque = range.torque_limit, .rate = 0.0f};
}

void HandSensor::observe(const Observation& seen) {
    if (!player_) {
        return;
    }
    if (seen.time < last_time_ - session_gap) {
        // Assigns a track of equal size: allocates nothing.
        *player_ = *at_start_;
    }
    last_time_ = seen.time;
    goal_ = player_->wanted(seen);
}

void HandSensor::approach(float dt) {
    const Vec3f way = goal_.translation - wanted_.translation;
    const float reach = max_speed * dt;
    wanted_.translation =
        way.norm() <= reach ? goal_.translation : Vec3f(wanted_.translation + way.normalized() * reach);
    const Vec3f turn = rotation_vector(goal_.rotation * wanted_.rotation.conjugate());
    const float turn_reach = max_turn * dt;
    if (turn.norm() <= turn_reach) {
        wanted_.rotation = goal_.rotation;
    } else {
        wanted_.rotation = (quaternion_from(turn.normalized() * turn_reach) * wanted_.rotation).normalized();
    }
}

Reading HandSensor::exchange(const Wrench& wrench, float elapsed) {
    float left = std::clamp(elapsed, 0.0f, longest_catch_up);
    while (left > 1e-6f) {
        const float dt = std::min(left, longest_step);
        approach(dt);
        hand_.step(wanted_, wrench, dt);
        left -= dt;
    }
    Reading reading;
    reading.motion = hand_.motion();
    reading.motion.pose = hand_.reported();
    reading.sample = ++sample_;
    return reading;
}

}  // namespace eti::devices
