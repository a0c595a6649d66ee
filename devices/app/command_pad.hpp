// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/bus/topics.hpp"
#include "common/model/live.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

namespace msg = bus::msg;

struct PadCommand {
    std::string_view name;  ///< of what lives
    float value = 0.0f;     ///< SI
};

/// Turns sticks and buttons into commands: axis 1 raises (up) and lowers the head and axis 0 opens (right)
/// and closes the jaw, at up to 10 deg/s, the rate of a nurse's hands; axis 4, a pad's right stick, tilts the
/// table (up: head-up); button 0 or a trigger on axis 5 is suction. A stick that rests sends nothing; a
/// posture is sent when it has moved by half a degree. Sticks move nothing until follow() has told from
/// where.
class CommandPad {
  public:
    /// Where the patient is, as the server says. Taken for a posture whose stick has rested for a second,
    /// which is longer than the patient follows a stick, so that scenario and instructor are gone on from,
    /// not undone.
    void follow(const LiveValues& patient);

    [[nodiscard]] std::vector<PadCommand> update(const Reading& reading, float elapsed);

    /// Whoever takes commands now knows of none: what is held is sent again.
    void begin_again() { suction_ = 0.0f; }
    /// What must not stay on when nobody's thumb is on the pad any more.
    [[nodiscard]] std::vector<PadCommand> let_go();

  private:
    /// A posture that a stick moves.
    struct Posture {
        const LiveField& field;
        std::optional<float> value{};  // [rad]
        float sent = 0.0f;             // [rad]
        float rested = 1e3f;           // [s]
    };
    static void follow(Posture& posture, const LiveValues& patient);
    [[nodiscard]] static bool move(Posture& posture, float stick, float elapsed);

    // The server refuses what lies beyond its bounds; here they only keep a stick from winding up.
    Posture head_{*live_field("head_elevation")};
    Posture jaw_{*live_field("jaw_opening")};
    Posture table_{*live_field("table_angle")};
    float suction_ = 0.0f;
    bool trigger_seen_ = false;  // pads without one report its axis as 0, which would be half pressed
};

}  // namespace eti::devices
