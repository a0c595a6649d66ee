// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

namespace eti::sound {

inline constexpr int sample_rate = 44100;  ///< [1/s]

/// Pitch [Hz] of a pulse oximeter's beep. It falls by the same share with each percent of saturation, which
/// listeners hear as equal steps; makers' scales differ from each other (Santamore & Cleaver 2004, J Clin
/// Monit Comput 18:89), so the numbers are chosen: 880 Hz at 100 %, an octave lower at 60 %. Held within 0
/// and 100 %.
[[nodiscard]] double beep_pitch(double saturation_percent);

/// One beep, samples from -1 to 1. All sounds begin and end in silence, without a step.
[[nodiscard]] std::vector<float> beep(double pitch_hz);

/// The click of a gum that is pressed too hard.
[[nodiscard]] std::vector<float> click();

/// A catheter that sucks: a noise whose end goes on in its beginning.
[[nodiscard]] std::vector<float> suction();

}  // namespace eti::sound
