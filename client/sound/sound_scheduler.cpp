// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/sound/sound_scheduler.hpp"

#include <algorithm>
#include <cmath>

#include "client/sound/tones.hpp"

namespace eti::sound {
namespace {

constexpr double swell_s = 0.05;
constexpr double click_rearm_s = 0.2;  // prevents rattling when the force fluctuates about its limit
constexpr double fastest_per_min = 300.0;

}  // namespace

SoundEvents SoundScheduler::advance(double dt, const Cue& cue) {
    SoundEvents out;
    if (cue.pulse && std::isfinite(cue.pulse->saturation_percent) && cue.pulse->rate_per_min > 0.0) {
        to_next_beat_ -= dt * std::min(cue.pulse->rate_per_min, fastest_per_min) / 60.0;
        if (to_next_beat_ <= 0.0) {
            out.beep_hz = beep_pitch(cue.pulse->saturation_percent);
            // Missed beats are not made up for.
            to_next_beat_ = std::max(0.0, to_next_beat_ + 1.0);
        }
    } else {
        to_next_beat_ = 0.0;
    }
    out.click = cue.gum_pressed && released_s_ >= click_rearm_s;
    released_s_ = cue.gum_pressed ? 0.0 : released_s_ + dt;
    const auto step = static_cast<float>(dt / swell_s);
    suction_ = std::clamp(suction_ + (cue.suction ? step : -step), 0.0f, 1.0f);
    out.suction = suction_;
    return out;
}

}  // namespace eti::sound
