// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

namespace eti::sound {

inline constexpr int sample_rate = 44100;  ///< [1/s]

/// Pitch [Hz] of a pulse oximeter's beep. It falls by the same ratio per percent of saturation, which
/// listeners perceive as equal steps. Manufacturers' scales differ (Santamore & Cleaver 2004, J Clin Monit
/// Comput 18:89), so the values are a choice: 880 Hz at 100 %, an octave lower at 60 %. The saturation is
/// clamped to 0-100 %.
[[nodiscard]] double beep_pitch(double saturation_percent);

/// One beep, samples from -1 to 1. All sounds start and end at zero without a discontinuity.
[[nodiscard]] std::vector<float> beep(double pitch_hz);

/// Click for excessive gum force.
[[nodiscard]] std::vector<float> click();

/// Noise of a suction catheter, seamlessly looped.
[[nodiscard]] std::vector<float> suction();

}  // namespace eti::sound
