// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "common/bus/topics.hpp"
#include "common/model/runtime_parameters.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

namespace msg = bus::msg;

struct PadCommand {
    std::string_view name;  ///< of a runtime parameter
    float value = 0.0f;     ///< SI
};

/// Maps sticks and buttons to commands. Axis 1 raises (up) and lowers the head and axis 0 opens (right) and
/// closes the jaw, at up to 10 deg/s, the speed of a nurse's hands. Axis 4, a pad's right stick, tilts the
/// table (up: head-up); axis 3, the same stick, presses the larynx back (right: more), and axes 6 and 7, a
/// directional pad, press it to the sides and up, by up to 3 N/s. Button 0 or a trigger on axis 5 is suction.
/// A stick at rest sends nothing; a value is sent when it has changed by half a degree or a quarter of a
/// newton. Sticks have no effect until follow() has given the current values.
class CommandPad {
  public:
    /// Updates posture and pressure from the server. It applies to a value whose stick has been at rest for a
    /// second, longer than the patient lags behind a stick. Changes by scenario and instructor are thus
    /// continued, not undone.
    void follow(const RuntimeParameters& patient);

    [[nodiscard]] std::vector<PadCommand> update(const Reading& reading, float elapsed);

    /// Call when a new server knows of no commands yet: held inputs are sent again.
    void resend_held_inputs() { suction_ = 0.0f; }
    /// Commands that end continuous inputs when the pad is no longer used.
    [[nodiscard]] std::vector<PadCommand> release();

  private:
    /// How a stick changes a value.
    struct Motion {
        float rate;        // [SI/s] at full deflection
        float sent_every;  // [SI]
        bool pressure;     // of fingers, which end it with the pad
    };
    static const Motion turning, pressing;
    /// A value that a stick controls.
    struct Target {
        const RuntimeParameterField& field;
        const Motion& motion;
        std::size_t axis;
        float sign;                    // of the value as the axis is positive
        std::optional<float> value{};  // SI
        float sent = 0.0f;             // SI
        float rested = 1e3f;           // [s]
        bool moved = false;            // by this pad
    };
    [[nodiscard]] static bool move(Target& target, float stick, float elapsed);

    // The server enforces its bounds; here they only prevent windup.
    std::array<Target, 6> targets_{{{*find_runtime_parameter("head_elevation"), turning, 1, -1.0f},
                                    {*find_runtime_parameter("jaw_opening"), turning, 0, 1.0f},
                                    {*find_runtime_parameter("table_angle"), turning, 4, -1.0f},
                                    {*find_runtime_parameter("laryngeal_pressure_back"), pressing, 3, 1.0f},
                                    {*find_runtime_parameter("laryngeal_pressure_right"), pressing, 6, 1.0f},
                                    {*find_runtime_parameter("laryngeal_pressure_up"), pressing, 7, -1.0f}}};
    float suction_ = 0.0f;
    bool trigger_seen_ = false;  // without a trigger, axis 5 reads 0, which would be half pressed
};

}  // namespace eti::devices
