// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/sound/tones.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace eti {
namespace {

using sound::sample_rate;

constexpr double tau = 2.0 * std::numbers::pi;

// Frequency from the time between the first and the last upward zero crossing.
double frequency_of(const std::vector<float>& samples) {
    double first = -1.0, last = -1.0;
    int periods = -1;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        if (samples[i - 1] < 0.0f && samples[i] >= 0.0f) {
            last = static_cast<double>(i) - static_cast<double>(samples[i] / (samples[i] - samples[i - 1]));
            first = periods < 0 ? last : first;
            ++periods;
        }
    }
    return periods * sample_rate / (last - first);
}

// Energy of a sound near a frequency, relative to a pure tone of the same power.
double power_at(const std::vector<float>& samples, double hz) {
    double cosine = 0.0, sine = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double phase = tau * hz * static_cast<double>(i) / sample_rate;
        cosine += static_cast<double>(samples[i]) * std::cos(phase);
        sine += static_cast<double>(samples[i]) * std::sin(phase);
    }
    return (cosine * cosine + sine * sine) / static_cast<double>(samples.size());
}

// Largest difference of neighbouring samples: a jump would be heard as a click.
float steepest(const std::vector<float>& samples) {
    float most = 0.0f;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        most = std::max(most, std::abs(samples[i] - samples[i - 1]));
    }
    return most;
}

TEST(BeepPitch, FallsGeometricallyWithSaturation) {
    EXPECT_NEAR(sound::beep_pitch(100.0), 880.0, 1e-9);
    EXPECT_NEAR(sound::beep_pitch(60.0), 440.0, 1e-9) << "an octave in 40 percent";
    for (int percent = 1; percent <= 100; ++percent) {
        EXPECT_NEAR(sound::beep_pitch(percent) / sound::beep_pitch(percent - 1), std::exp2(1.0 / 40.0),
                    1e-12);
    }
    EXPECT_EQ(sound::beep_pitch(130.0), sound::beep_pitch(100.0));
    EXPECT_EQ(sound::beep_pitch(-5.0), sound::beep_pitch(0.0));
}

TEST(Beep, HasGivenPitchAndNoDiscontinuity) {
    for (const double hz : {311.0, 440.0, 880.0}) {
        const std::vector<float> samples = sound::beep(hz);
        // To a hundredth of the step between two percents of saturation (1.7 %).
        EXPECT_NEAR(frequency_of({samples.begin() + 500, samples.end() - 500}), hz, 1.7e-4 * hz)
            << "without ramps";
        EXPECT_EQ(samples.front(), 0.0f);
        EXPECT_NEAR(samples.back(), 0.0f, 1e-6f);
        // No steeper than a steady tone of its loudness, 0.5.
        EXPECT_LE(steepest(samples), 0.5 * tau * hz / sample_rate);
        EXPECT_LE(*std::ranges::max_element(samples), 0.5f);
    }
}

TEST(Click, IsShortAndDecays) {
    const std::vector<float> samples = sound::click();
    EXPECT_LE(samples.size(), static_cast<std::size_t>(0.05 * sample_rate));
    EXPECT_EQ(samples.front(), 0.0f);
    EXPECT_NEAR(samples.back(), 0.0f, 1e-6f);
    const auto half = static_cast<std::ptrdiff_t>(samples.size() / 2);
    const auto loudest = [](auto from, auto to) {
        float most = 0.0f;
        std::for_each(from, to, [&](float s) { most = std::max(most, std::abs(s)); });
        return most;
    };
    // exp(-15 ms / 5 ms) of the initial amplitude.
    EXPECT_LT(loudest(samples.begin() + half, samples.end()),
              0.06f * loudest(samples.begin(), samples.begin() + half));
    EXPECT_LE(loudest(samples.begin(), samples.end()), 1.0f);
}

TEST(Suction, LoopsSeamlesslyAndIsBandLimited) {
    const std::vector<float> samples = sound::suction();
    std::vector<float> around(samples.end() - 50, samples.end());
    around.insert(around.end(), samples.begin(), samples.begin() + 50);
    EXPECT_LE(steepest(around), steepest(samples) * 1.01f);
    // Where the two halves were joined, the step is no larger than the noise's own.
    EXPECT_LE(std::abs(samples.front() - samples.back()), steepest(samples));
    double middle = 0.0, high = 0.0, low = 0.0;
    for (int i = 0; i < 40; ++i) {
        middle += power_at(samples, 700.0 + 7.0 * i);
        high += power_at(samples, 15000.0 + 40.0 * i);
        low += power_at(samples, 20.0 + 0.5 * i);
    }
    // First-order slopes: from 2.5 kHz to 15.8 kHz 16 dB, from 250 Hz to 30 Hz 18 dB.
    EXPECT_GT(middle, 10.0 * high);
    EXPECT_GT(middle, 10.0 * low);
    EXPECT_LE(*std::ranges::max_element(samples), 1.0f);
}

}  // namespace
}  // namespace eti
