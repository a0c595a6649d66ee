// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>

namespace eti::sound {

/// What of a session is heard.
struct Cue {
    struct Pulse {
        double saturation_percent = 100.0;
        double rate_per_min = 140.0;
    };
    std::optional<Pulse> pulse;  ///< of the monitor, where there is one
    bool gum_pressed = false;    ///< too hard
    bool suction = false;
};

/// What is to be played now.
struct Sounding {
    std::optional<double> beep_hz;
    bool click = false;
    float suction = 0.0f;  ///< loudness, 0 to 1
};

/// Decides when which sound begins: a beep with each beat, a click when the gum begins to be pressed too
/// hard, and the noise of suction, which swells and dies away.
class Score {
  public:
    /// `dt` [s] after the last call.
    [[nodiscard]] Sounding advance(double dt, const Cue& cue);

  private:
    double to_next_beat_ = 0.0;  // share of a beat
    double released_s_ = 1.0;    // since when the gum is not pressed
    float suction_ = 0.0f;
};

}  // namespace eti::sound
