// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/arrival_statistics.hpp"

#include <gtest/gtest.h>

namespace eti::client {
namespace {

msg::Header header(std::uint32_t number, std::uint64_t sent_ns) {
    msg::Header out;
    out.number(number);
    out.send_time_ns(sent_ns);
    return out;
}

TEST(ArrivalStatistics, CountsAgesAndMissedStates) {
    ArrivalStatistics arrival(2);
    arrival.note(header(100, 1'000'000), 3'000'000);
    arrival.note(header(100, 1'000'000), 5'000'000);  // another chunk of the same state
    arrival.note(header(102, 9'000'000), 10'000'000);
    EXPECT_EQ(arrival.missed(), 0u);
    arrival.note(header(108, 20'000'000), 21'000'000);  // 104 and 106 were lost
    EXPECT_EQ(arrival.missed(), 2u);
    arrival.note(header(106, 19'000'000), 21'000'000);  // late, not lost: the loss count does not decrease
    EXPECT_EQ(arrival.missed(), 2u);
    arrival.note(header(110, 22'000'000), 23'000'000);
    EXPECT_EQ(arrival.missed(), 2u);
    arrival.note(header(1110, 30'000'000), 31'000'000);
    EXPECT_EQ(arrival.missed(), 501u);
    arrival.note(header(4, 30'000'000), 31'000'000);  // another session
    arrival.note(header(6, 30'000'000), 31'000'000);
    EXPECT_EQ(arrival.missed(), 501u);
    EXPECT_EQ(arrival.count(), 9u);
    EXPECT_DOUBLE_EQ(arrival.mean_ms(), (2.0 + 4.0 + 1.0 + 1.0 + 2.0 + 1.0 + 1.0 + 1.0 + 1.0) / 9.0);
    EXPECT_DOUBLE_EQ(arrival.max_ms(), 4.0);
}

// A clock behind the sender's gives negative ages, not huge ones.
TEST(ArrivalStatistics, LaggingClockGivesNegativeAges) {
    ArrivalStatistics arrival(2);
    arrival.note(header(2, 5'000'000), 4'000'000);
    EXPECT_DOUBLE_EQ(arrival.mean_ms(), -1.0);
    EXPECT_DOUBLE_EQ(arrival.max_ms(), -1.0);
}

}  // namespace
}  // namespace eti::client
