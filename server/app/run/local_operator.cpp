// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/local_operator.hpp"

#include "common/model/pace.hpp"

namespace eti::app {

namespace {

// Device processes run at 1 kHz; six ticks per step are 1.08 kHz.
constexpr int ticks_per_step = 6;

}  // namespace

LocalOperator::LocalOperator(const OperatorScript& script, const Laryngoscope& scope, const Tube& tube,
                             std::uint64_t seed, const Observation& start)
    : blade_track_(script, Tool::laryngoscope, scope.blade_length, 0.0f, seed),
      tube_track_(script, Tool::tube, tube.grip_from_tip, 1.0f / tube.curve_radius, seed),
      blade_hand_(HandSettings{}, blade_track_.wanted(start)),
      tube_hand_(HandSettings{}, tube_track_.wanted(start)) {}

void LocalOperator::apply_to(scene::Inputs& inputs) const {
    inputs.laryngoscope = blade_hand_.reported();
    inputs.tube_grip = tube_hand_.reported();
}

void LocalOperator::advance(const Observation& observation, const scene::Snapshot& snapshot) {
    constexpr float dt = step_duration / ticks_per_step;
    Observation seen = observation;
    Motion proxy{snapshot.proxy, snapshot.proxy_velocity, snapshot.proxy_angular_velocity};
    for (int tick = 0; tick < ticks_per_step; ++tick) {
        seen.time = observation.time + static_cast<double>(dt) * tick;
        // Between steps the proxy is extrapolated by its velocity, as in the haptic loop.
        proxy.pose.translation =
            snapshot.proxy.translation + snapshot.proxy_velocity * (dt * static_cast<float>(tick));
        Wrench wrench = coupling_wrench(blade_hand_.motion(), proxy, coupling_);
        wrench.force += coupling_.tissue_gain * snapshot.tissue_force;
        wrench.torque += coupling_.tissue_gain * snapshot.tissue_torque;
        blade_hand_.step(blade_track_.wanted(seen), clamp_to_limits(wrench, coupling_), dt);
        // A tracked tube has no force feedback.
        tube_hand_.step(tube_track_.wanted(seen), Wrench{}, dt);
    }
}

}  // namespace eti::app
