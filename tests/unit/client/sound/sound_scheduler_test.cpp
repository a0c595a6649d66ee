// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/sound/sound_scheduler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/sound/tones.hpp"

namespace eti {
namespace {

using sound::Cue;
using sound::SoundScheduler;

constexpr double dt = 0.005;

int beeps_in(SoundScheduler& scheduler, double seconds, const Cue& cue) {
    int count = 0;
    for (int i = 0; i < static_cast<int>(std::lround(seconds / dt)); ++i) {
        count += scheduler.advance(dt, cue).beep_hz ? 1 : 0;
    }
    return count;
}

TEST(SoundScheduler, BeepsAtHeartRateWithSaturationPitch) {
    SoundScheduler scheduler;
    const Cue cue{Cue::Pulse{82.0, 150.0}, false, false};
    EXPECT_NEAR(*scheduler.advance(dt, cue).beep_hz, sound::beep_pitch(82.0), 1e-9);
    EXPECT_EQ(beeps_in(scheduler, 60.0, cue), 150);
    EXPECT_NEAR(beeps_in(scheduler, 60.0, {Cue::Pulse{82.0, 60.0}, false, false}), 60, 1);
}

TEST(SoundScheduler, IsSilentWithoutMonitorOrForNonFiniteValues) {
    SoundScheduler scheduler;
    EXPECT_EQ(beeps_in(scheduler, 5.0, {}), 0);
    EXPECT_EQ(beeps_in(scheduler, 5.0, {Cue::Pulse{NAN, 150.0}, false, false}), 0);
    EXPECT_EQ(beeps_in(scheduler, 5.0, {Cue::Pulse{90.0, NAN}, false, false}), 0);
}

TEST(SoundScheduler, DoesNotCatchUpMissedBeats) {
    SoundScheduler scheduler;
    const Cue cue{Cue::Pulse{90.0, 150.0}, false, false};
    (void)scheduler.advance(30.0, cue);
    EXPECT_LE(beeps_in(scheduler, 1.0, cue), 4);
}

TEST(SoundScheduler, ClicksOnceAtOnsetOfGumPressure) {
    SoundScheduler scheduler;
    int clicks = 0;
    // In tenths of a second: pressed, fluctuating about the limit, released, pressed again.
    for (const bool pressed : {false, true, true, false, true, true, false, false, true, true}) {
        clicks += scheduler.advance(0.1, {std::nullopt, pressed, false}).click ? 1 : 0;
    }
    EXPECT_EQ(clicks, 2);
}

TEST(SoundScheduler, SuctionFadesInAndOutWithoutStep) {
    SoundScheduler scheduler;
    float last = 0.0f;
    for (int i = 0; i < 40; ++i) {
        const float now = scheduler.advance(dt, {std::nullopt, false, i < 20}).suction;
        EXPECT_LE(std::abs(now - last), 0.1f + 1e-5f) << "5 ms of 50";
        last = now;
        if (i == 19) {
            EXPECT_EQ(now, 1.0f);
        }
    }
    EXPECT_EQ(last, 0.0f);
}

}  // namespace
}  // namespace eti
