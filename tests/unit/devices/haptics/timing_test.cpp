// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/timing.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/time.h>

#include <atomic>

namespace eti::devices {
namespace {

TEST(CycleStatistics, PercentilesOfACountedDistribution) {
    CycleStatistics statistics;
    EXPECT_EQ(statistics.percentile(0.5), 0.0);
    EXPECT_EQ(statistics.share_over(1e-3), 0.0);
    for (int i = 0; i < 990; ++i) {
        statistics.record(1'000'500);
    }
    for (int i = 0; i < 9; ++i) {
        statistics.record(1'500'500);
    }
    statistics.record(40'000'000);
    EXPECT_EQ(statistics.count(), 1000u);
    // Bins of 1 us, named by their upper edge.
    EXPECT_NEAR(statistics.percentile(0.5), 1.001e-3, 1e-9);
    EXPECT_NEAR(statistics.percentile(0.99), 1.001e-3, 1e-9);
    EXPECT_NEAR(statistics.percentile(0.999), 1.501e-3, 1e-9);
    EXPECT_DOUBLE_EQ(statistics.percentile(1.0), 0.04);
    EXPECT_DOUBLE_EQ(statistics.longest(), 0.04);
    EXPECT_DOUBLE_EQ(statistics.share_over(1.2e-3), 0.010);
    EXPECT_DOUBLE_EQ(statistics.share_over(2e-3), 0.001);
}

TEST(CycleStatistics, NoPercentileExceedsTheLongest) {
    CycleStatistics statistics;
    statistics.record(4'192'838);
    EXPECT_DOUBLE_EQ(statistics.percentile(0.99), statistics.longest());
}

TEST(CycleStatistics, AcceptsAnyClockDifference) {
    CycleStatistics statistics;
    statistics.record(-5);
    statistics.record(0);
    statistics.record(std::int64_t{1} << 60);
    EXPECT_EQ(statistics.count(), 3u);
    EXPECT_NEAR(statistics.percentile(0.5), 1e-6, 1e-12);
}

TEST(Sleep, IsNotCutShortBySignals) {
    struct sigaction ignoring {};
    struct sigaction before {};
    static std::atomic<int> signals{0};
    ignoring.sa_handler = [](int) { ++signals; };
    sigaction(SIGALRM, &ignoring, &before);
    const itimerval every_millisecond{{0, 1000}, {0, 1000}};
    setitimer(ITIMER_REAL, &every_millisecond, nullptr);
    const std::int64_t until = monotonic_ns() + 20'000'000;
    sleep_until_ns(until);
    const std::int64_t woken = monotonic_ns();
    const itimerval never{};
    setitimer(ITIMER_REAL, &never, nullptr);
    sigaction(SIGALRM, &before, nullptr);
    EXPECT_GE(woken, until);
    EXPECT_GT(signals, 0);
    sleep_until_ns(until);  // the past: returns at once
}

}  // namespace
}  // namespace eti::devices
