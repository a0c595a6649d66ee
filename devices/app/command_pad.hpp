// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "common/bus/topics.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

namespace msg = bus::msg;

/// Where the patient is when the pad begins; the scenario's, which the bus does not tell.
struct PadCommands {
    float head_elevation_deg = 10.0f;
    float jaw_opening_deg = 20.0f;
    float table_angle_deg = 0.0f;
};

struct PadCommand {
    msg::CommandKind kind = msg::COMMAND_SUCTION;
    float value = 0.0f;  ///< SI, as its kind says
};

/// Turns sticks and buttons into commands: axis 1 raises (up) and lowers the head and axis 0 opens (right)
/// and closes the jaw, at up to 10 deg/s, the rate of a nurse's hands; axis 4, a pad's right stick, tilts the
/// table (up: head-up); button 0 or a trigger on axis 5 is suction. A stick that rests sends nothing; a
/// posture is sent when it has moved by half a degree.
class CommandPad {
  public:
    explicit CommandPad(const PadCommands& start);

    [[nodiscard]] std::vector<PadCommand> update(const Reading& reading, float elapsed);

  private:
    /// A posture that a stick moves.
    struct Posture {
        msg::CommandKind kind;
        float value, least, most;  // [rad]
        float sent;                // [rad]
    };
    [[nodiscard]] static bool move(Posture& posture, float stick, float elapsed);

    Posture head_, jaw_, table_;
    float suction_ = 0.0f;
    bool trigger_seen_ = false;  // pads without one report its axis as 0, which would be half pressed
};

}  // namespace eti::devices
