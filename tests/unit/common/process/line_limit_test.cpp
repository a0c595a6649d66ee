// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/line_limit.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

using namespace std::chrono_literals;

TEST(LineLimit, LetsOneLineASecondThroughForEachCause) {
    LineLimit limit;
    const auto start = LineLimit::Clock::now();
    EXPECT_EQ(limit.allow("a", start), 0u);
    EXPECT_EQ(limit.allow("b", start), 0u);
    for (int i = 0; i < 1000; ++i) {
        EXPECT_EQ(limit.allow("a", start + i * 900us), std::nullopt);
    }
    EXPECT_EQ(limit.allow("a", start + 1s), 1000u);
    EXPECT_EQ(limit.allow("a", start + 2s), 0u);
    EXPECT_EQ(and_more(0), "");
    EXPECT_EQ(and_more(1000), " (1000 more like it)");
}

TEST(LineLimit, CausesWithoutEndShareALine) {
    LineLimit limit;
    const auto start = LineLimit::Clock::now();
    std::size_t lines = 0;
    for (int i = 0; i < 10'000; ++i) {
        lines += limit.allow("cause " + std::to_string(i), start).has_value() ? 1 : 0;
    }
    EXPECT_EQ(lines, LineLimit::most_causes);
}

}  // namespace
}  // namespace eti
