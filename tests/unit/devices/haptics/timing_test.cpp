// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/timing.hpp"

#include <gtest/gtest.h>

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
    // Bins of 1 us, told by their upper edge.
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

TEST(CycleStatistics, TakesWhatAClockMayGive) {
    CycleStatistics statistics;
    statistics.record(-5);
    statistics.record(0);
    statistics.record(std::int64_t{1} << 60);
    EXPECT_EQ(statistics.count(), 3u);
    EXPECT_NEAR(statistics.percentile(0.5), 1e-6, 1e-12);
}

TEST(Sleep, EndsNoEarlierThanAsked) {
    const std::int64_t start = monotonic_ns();
    sleep_until_ns(start + 3'000'000);
    EXPECT_GE(monotonic_ns(), start + 3'000'000);
    sleep_until_ns(start);  // the past: returns at once
}

}  // namespace
}  // namespace eti::devices
