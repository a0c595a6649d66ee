// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

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
/// table (up: head-up). Button 0 or a trigger on axis 5 is suction. A stick at rest sends nothing; a posture
/// is sent when it has changed by half a degree. Sticks have no effect until follow() has given the current
/// posture.
class CommandPad {
  public:
    /// Updates the patient's posture from the server. It applies to a posture whose stick has been at rest
    /// for a second, longer than the patient lags behind a stick. Changes by scenario and instructor are thus
    /// continued, not undone.
    void follow(const RuntimeParameters& patient);

    [[nodiscard]] std::vector<PadCommand> update(const Reading& reading, float elapsed);

    /// Call when a new server knows of no commands yet: held inputs are sent again.
    void resend_held_inputs() { suction_ = 0.0f; }
    /// Commands that end continuous inputs when the pad is no longer used.
    [[nodiscard]] std::vector<PadCommand> release();

  private:
    /// A posture parameter that a stick controls.
    struct Posture {
        const RuntimeParameterField& field;
        std::optional<float> value{};  // [rad]
        float sent = 0.0f;             // [rad]
        float rested = 1e3f;           // [s]
    };
    static void follow(Posture& posture, const RuntimeParameters& patient);
    [[nodiscard]] static bool move(Posture& posture, float stick, float elapsed);

    // The server enforces its bounds; here they only prevent windup.
    Posture head_{*find_runtime_parameter("head_elevation")};
    Posture jaw_{*find_runtime_parameter("jaw_opening")};
    Posture table_{*find_runtime_parameter("table_angle")};
    float suction_ = 0.0f;
    bool trigger_seen_ = false;  // without a trigger, axis 5 reads 0, which would be half pressed
};

}  // namespace eti::devices
