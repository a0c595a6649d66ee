// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/breathing.hpp"

#include <algorithm>
#include <cmath>

namespace eti::render {
namespace {

// 50 breaths a minute: the middle of the 40 to 60 that neonatal resuscitation teaches, and of a newborn's
// own.
constexpr double period_s = 60.0 / 50.0;
// Inspiratory time 0.3 to 0.5 s; an inflation approaches the ventilator's pressure, and an expiration the
// rest volume, with the time constant of a newborn's respiratory system, 0.1 to 0.15 s.
constexpr double inspiration_s = 0.4, time_constant_s = 0.12;
constexpr double longest_step_s = 0.02;

}  // namespace

void Breathing::update(double time_s, bool ventilated) {
    if (!time_s_ || time_s < *time_s_) {
        phase_s_ = inspiration_s;
        inflation_ = 0.0;
    } else {
        // After a gap of many breaths only the last one matters.
        double left = std::min(time_s - *time_s_, 4.0 * period_s);
        while (left > 0.0) {
            const double step = std::min(left, longest_step_s);
            left -= step;
            phase_s_ = std::fmod(phase_s_ + step, period_s);
            const double towards = ventilated && phase_s_ < inspiration_s ? 1.0 : 0.0;
            inflation_ += (1.0 - std::exp(-step / time_constant_s)) * (towards - inflation_);
        }
    }
    time_s_ = time_s;
}

}  // namespace eti::render
