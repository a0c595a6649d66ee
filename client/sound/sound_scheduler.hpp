// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

namespace eti::sound {

/// Audible state of a session.
struct Cue {
    struct Pulse {
        double saturation_percent = 100.0;
        double rate_per_min = 140.0;
    };
    std::optional<Pulse> pulse;  ///< of the monitor, if present
    bool gum_pressed = false;    ///< above the force limit
    bool suction = false;
};

/// Sounds to play now.
struct SoundEvents {
    std::optional<double> beep_hz;
    bool click = false;
    float suction = 0.0f;  ///< loudness, 0 to 1
};

/// Schedules sounds: a beep per heartbeat, a click when the gum force first exceeds its limit, and suction
/// noise, which fades in and out.
class SoundScheduler {
  public:
    /// `dt` [s] since the last call.
    [[nodiscard]] SoundEvents advance(double dt, const Cue& cue);

  private:
    double to_next_beat_ = 0.0;  // fraction of a beat
    double released_s_ = 1.0;    // time since the gum was last pressed
    float suction_ = 0.0f;
};

}  // namespace eti::sound
