// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/log_throttle.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

using namespace std::chrono_literals;

TEST(LogThrottle, AllowsOneLinePerSecondAndCause) {
    LogThrottle limit;
    const auto start = LogThrottle::Clock::now();
    EXPECT_EQ(limit.allow("a", start), 0u);
    EXPECT_EQ(limit.allow("b", start), 0u);
    for (int i = 0; i < 1000; ++i) {
        EXPECT_EQ(limit.allow("a", start + i * 900us), std::nullopt);
    }
    EXPECT_EQ(limit.allow("a", start + 1s), 1000u);
    EXPECT_EQ(limit.allow("a", start + 2s), 0u);
    EXPECT_EQ(suppressed_suffix(0), "");
    EXPECT_EQ(suppressed_suffix(1000), " (1000 more like it)");
}

TEST(LogThrottle, NumberOfCausesIsBounded) {
    LogThrottle limit;
    const auto start = LogThrottle::Clock::now();
    std::size_t lines = 0;
    for (int i = 0; i < 10'000; ++i) {
        lines += limit.allow("cause " + std::to_string(i), start).has_value() ? 1 : 0;
    }
    EXPECT_EQ(lines, LogThrottle::max_causes);
}

}  // namespace
}  // namespace eti
