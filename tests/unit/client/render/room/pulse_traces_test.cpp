// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/pulse_traces.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace eti::render {
namespace {

// R waves among the columns: maximal runs of columns that reach 0.8.
int r_waves(const PulseTraces& traces) {
    int count = 0;
    bool before = false;
    for (const PulseTraces::Column& column : traces.values()) {
        const bool high = column.ecg_high > 0.8f;
        count += high && !before ? 1 : 0;
        before = high;
    }
    return count;
}

TEST(PulseTraces, BeatAtTheRate) {
    PulseTraces traces;
    traces.update(100.0, 150.0);
    // 2.5 a second on a screen of 4 s; the sweep may cut one.
    EXPECT_NEAR(r_waves(traces), 10, 1);
    EXPECT_NEAR(traces.beats().back() - traces.beats().front(),
                0.4 * static_cast<double>(traces.beats().size() - 1), 1e-9);
}

TEST(PulseTraces, KeepTheirBeatsAsTheRateChanges) {
    PulseTraces traces;
    traces.update(10.0, 120.0);
    const double last = traces.beats().back();
    traces.update(10.4, 60.0);
    EXPECT_DOUBLE_EQ(traces.beats().back(), last) << "0.5 s after a beat comes none at 60 a minute";
    traces.update(11.1, 60.0);
    EXPECT_DOUBLE_EQ(traces.beats().back(), last + 1.0);
}

TEST(PulseTraces, AreFlatWithoutASignal) {
    PulseTraces traces;
    traces.update(3.0, 140.0);
    EXPECT_GT(r_waves(traces), 0);
    traces.update(3.1, std::nullopt);
    for (const PulseTraces::Column& column : traces.values()) {
        EXPECT_EQ(column.ecg_high, 0.0f);
        EXPECT_EQ(column.pleth_high, 0.0f);
    }
    EXPECT_TRUE(traces.beats().empty());
}

TEST(PulseTraces, DependOnlyOnTheirHistory) {
    PulseTraces one, other;
    for (const double time : {1.0, 1.1, 1.2, 1.3}) {
        one.update(time, 140.0);
        other.update(time, 140.0);
    }
    EXPECT_EQ(one.head(), other.head());
    EXPECT_TRUE(std::ranges::equal(one.values(), other.values(), {}, &PulseTraces::Column::ecg_high,
                                   &PulseTraces::Column::ecg_high));
    // A session that starts again.
    other.update(0.5, 140.0);
    EXPECT_LE(other.beats().back(), 0.5);
}

TEST(PulseTraces, PlethysmogramIsAPulse) {
    constexpr float period = 0.43f;
    float low = 1.0f, high = 0.0f;
    for (float t = 0.0f; t < period; t += 1e-3f) {
        low = std::min(low, plethysmogram(t, period));
        high = std::max(high, plethysmogram(t, period));
    }
    EXPECT_NEAR(low, 0.0f, 0.02f);
    EXPECT_NEAR(high, 1.0f, 0.05f);
    EXPECT_NEAR(plethysmogram(0.0f, period), plethysmogram(period, period), 1e-3f) << "continuous";
}

}  // namespace
}  // namespace eti::render
