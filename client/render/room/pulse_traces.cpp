// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/pulse_traces.hpp"

#include <algorithm>
#include <cmath>

namespace eti::render {
namespace {

constexpr double slowest = 10.0, fastest = 300.0;  // [1/min]

float bump(float t, float centre, float width) {
    const float away = (t - centre) / width;
    return std::exp(-away * away);
}

}  // namespace

float electrocardiogram(float after, float period) {
    // A newborn's intervals [s]: P 0.05, PR 0.10, QRS 0.06; the T wave moves with the rate (Bazett 1920).
    const float t_wave = 0.12f + 0.20f * std::sqrt(period);
    return 0.14f * bump(after, 0.035f, 0.018f) - 0.10f * bump(after, 0.093f, 0.007f) +
           bump(after, 0.108f, 0.008f) - 0.22f * bump(after, 0.125f, 0.008f) +
           0.24f * bump(after, t_wave, 0.035f);
}

float plethysmogram(float after, float period) {
    // The pulse arrives at the hand some 0.1 s after the R wave, rises in a fifth of the period, and falls
    // over the rest with a dicrotic wave.
    const float t = std::fmod(after - 0.2f + period, period) / period;
    const float rise = 0.22f;
    const float main = t < rise ? 0.5f - 0.5f * std::cos(3.14159f * t / rise)
                                : std::exp(-3.2f * (t - rise)) -
                                      std::exp(-3.2f * (1.0f - rise)) * (t - rise) / (1.0f - rise);
    return main + 0.10f * bump(t, 0.55f, 0.08f);
}

void PulseTraces::update(double time_s, std::optional<double> rate) {
    const bool beating = rate && std::isfinite(*rate) && *rate > 0.0;
    const double now = beating ? std::clamp(*rate, slowest, fastest) : 0.0;
    if (time_s == time_s_ && now == rate_) {
        return;
    }
    constexpr double shown = sweep_s + 60.0 / slowest;
    if (time_s < time_s_ || time_s - time_s_ > sweep_s || !beating || rate_ == 0.0) {
        beats_.clear();
        for (double beat = time_s; beating && beat > time_s - shown; beat -= 60.0 / now) {
            beats_.insert(beats_.begin(), beat);
        }
    }
    while (beating && beats_.back() + 60.0 / now <= time_s) {
        beats_.push_back(beats_.back() + 60.0 / now);
    }
    std::erase_if(beats_, [&](double beat) { return beat < time_s - shown; });
    time_s_ = time_s;
    rate_ = now;
    const double turns = time_s / sweep_s;
    head_ = static_cast<int>((turns - std::floor(turns)) * columns) % columns;
    constexpr int samples = 4;
    constexpr double column_s = sweep_s / columns;
    for (int column = 0; column < columns; ++column) {
        const int age = (head_ - column + columns) % columns;
        Column& range = values_[static_cast<std::size_t>(column)];
        range = {1.0f, -1.0f, 1.0f, -1.0f};
        // One sample into the next column, so that steep parts stay connected.
        for (int k = 0; k <= samples; ++k) {
            const double t = time_s - column_s * (age - static_cast<double>(k) / samples);
            float ecg = 0.0f, pleth = 0.0f;
            const auto next = std::ranges::upper_bound(beats_, t);
            if (beating && next != beats_.begin()) {
                const double period = next != beats_.end() ? *next - *(next - 1) : 60.0 / now;
                const auto after = static_cast<float>(t - *(next - 1));
                ecg = electrocardiogram(after, static_cast<float>(period));
                pleth = plethysmogram(after, static_cast<float>(period));
            }
            range = {std::min(range.ecg_low, ecg), std::max(range.ecg_high, ecg),
                     std::min(range.pleth_low, pleth), std::max(range.pleth_high, pleth)};
        }
    }
}

}  // namespace eti::render
