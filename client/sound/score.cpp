// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/sound/score.hpp"

#include <algorithm>
#include <cmath>

#include "client/sound/tones.hpp"

namespace eti::sound {
namespace {

constexpr double swell_s = 0.05;
constexpr double let_go_s = 0.2;  // a force that trembles about its limit would rattle
constexpr double fastest_per_min = 300.0;

}  // namespace

Sounding Score::advance(double dt, const Cue& cue) {
    Sounding out;
    if (cue.pulse && std::isfinite(cue.pulse->saturation_percent) && cue.pulse->rate_per_min > 0.0) {
        to_next_beat_ -= dt * std::min(cue.pulse->rate_per_min, fastest_per_min) / 60.0;
        if (to_next_beat_ <= 0.0) {
            out.beep_hz = beep_pitch(cue.pulse->saturation_percent);
            // What was missed is not made up for.
            to_next_beat_ = std::max(0.0, to_next_beat_ + 1.0);
        }
    } else {
        to_next_beat_ = 0.0;
    }
    out.click = cue.gum_pressed && released_s_ >= let_go_s;
    released_s_ = cue.gum_pressed ? 0.0 : released_s_ + dt;
    const auto step = static_cast<float>(dt / swell_s);
    suction_ = std::clamp(suction_ + (cue.suction ? step : -step), 0.0f, 1.0f);
    out.suction = suction_;
    return out;
}

}  // namespace eti::sound
