// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/sound/tones.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "common/math/random.hpp"

namespace eti::sound {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;
constexpr double pitch_at_100_hz = 880.0, percent_an_octave = 40.0;
constexpr double beep_s = 0.12, ramp_s = 0.01, loudness = 0.5;
constexpr double click_s = 0.03, click_ramp_s = 0.5e-3, click_decay_s = 5e-3;
constexpr double suction_s = 2.0, seam_s = 0.1;
constexpr double lowest_hz = 250.0, highest_hz = 2500.0;  // of the noise

std::size_t samples_of(double seconds) {
    return static_cast<std::size_t>(std::lround(seconds * sample_rate));
}

double time_of(std::size_t sample) {
    return static_cast<double>(sample) / sample_rate;
}

// Raised-cosine fade: 0 at both ends of a sound of `length` [s], 1 in between.
double fade(double time, double length, double ramp) {
    const double from_end = std::clamp(std::min(time, length - time) / ramp, 0.0, 1.0);
    return 0.5 - 0.5 * std::cos(std::numbers::pi * from_end);
}

// Coefficient of a first-order low pass, per sample.
double share_of(double cutoff_hz) {
    return 1.0 - std::exp(-tau * cutoff_hz / sample_rate);
}

}  // namespace

double beep_pitch(double saturation_percent) {
    return pitch_at_100_hz *
           std::exp2((std::clamp(saturation_percent, 0.0, 100.0) - 100.0) / percent_an_octave);
}

std::vector<float> beep(double pitch_hz) {
    std::vector<float> out(samples_of(beep_s) + 1);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double t = time_of(i);
        out[i] = static_cast<float>(loudness * fade(t, beep_s, ramp_s) * std::sin(tau * pitch_hz * t));
    }
    return out;
}

std::vector<float> click() {
    std::vector<float> out(samples_of(click_s) + 1);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double t = time_of(i);
        const double ring = std::sin(tau * 1800.0 * t) + 0.6 * std::sin(tau * 2900.0 * t);
        out[i] = static_cast<float>(loudness * fade(t, click_s, click_ramp_s) * std::exp(-t / click_decay_s) *
                                    ring);
    }
    return out;
}

std::vector<float> suction() {
    const std::size_t length = samples_of(suction_s), seam = samples_of(seam_s);
    std::vector<double> noise(length + seam);
    Random random(7);
    double low = 0.0, lower = 0.0;
    for (double& sample : noise) {
        low += share_of(highest_hz) * (2.0 * random.uniform() - 1.0 - low);
        lower += share_of(lowest_hz) * (low - lower);
        sample = low - lower;
    }
    // The samples beyond the end are cross-faded into the beginning with equal power, so that the loop is
    // seamless.
    std::vector<float> out(length);
    for (std::size_t i = 0; i < length; ++i) {
        const double share = i < seam ? static_cast<double>(i) / static_cast<double>(seam) : 1.0;
        const double after = i < seam ? noise[length + i] : 0.0;
        out[i] = static_cast<float>(
            loudness * (std::sin(0.25 * tau * share) * noise[i] + std::cos(0.25 * tau * share) * after));
    }
    return out;
}

}  // namespace eti::sound
