// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Reference: the sequence number that a writer can reach at a sample rate within a time; and the exact
// heartbeat of 52 bytes on which eti-haptics, eti-tracker and eti-client hung indefinitely.
#include "common/bus/guard/sequence_number_guard.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <vector>

namespace eti::bus {
namespace {

using namespace std::chrono_literals;

const SequenceNumberGuard::Clock::time_point start{1h};

WriterId numbered_writer(std::uint8_t n) {
    return {{1, 15, 120, 253, 3, 18, 137, 50, 0, 0, 0, 0}, {0, 0, n, 2}};
}

/// From the writer of eti/session_status, first and last sample 1,000,000,033; it had written 33.
std::vector<std::uint8_t> deadly() {
    return {0x52, 0x54, 0x50, 0x53,  //
            0x02, 0x03, 0x01, 0x0f,  //
            0x01, 0x0f, 0x78, 0xfd,  //
            0x03, 0x12, 0x89, 0x32,  //
            0x00, 0x00, 0x00, 0x00,  //
            0x07, 0x01, 0x1c, 0x00,  //
            0x00, 0x00, 0x00, 0x00,  //
            0x00, 0x00, 0x14, 0x02,  //
            0x00, 0x00, 0x00, 0x00,  //
            0x21, 0xca, 0x9a, 0x3b,  //
            0x00, 0x00, 0x00, 0x00,  //
            0x21, 0xca, 0x9a, 0x3b,  //
            0x59, 0x00, 0x00, 0x00};
}

bool refused(SequenceNumberGuard& reached, const std::vector<std::uint8_t>& datagram) {
    return !is_well_formed(datagram, [&](const WriterSubmessage& written) {
        return written.up_to > 0 && !reached.plausible(written.writer, written.up_to, true, start);
    });
}

TEST(SequenceNumberGuard, HugeHeartbeatThatHungProgramsIsRefused) {
    EXPECT_TRUE(is_well_formed(deadly())) << "it is sound RTPS";
    SequenceNumberGuard fresh;
    EXPECT_TRUE(refused(fresh, deadly())) << "as the first of its writer";
    SequenceNumberGuard reached;
    ASSERT_TRUE(reached.plausible(numbered_writer(20), 33, true, start));
    EXPECT_TRUE(refused(reached, deadly()));
    EXPECT_TRUE(reached.plausible(numbered_writer(20), 34, true, start)) << "its writer is heard on";
}

TEST(SequenceNumberGuard, OnlyTheServerMayStartFarOn) {
    SequenceNumberGuard reached;
    EXPECT_TRUE(reached.plausible(numbered_writer(1), max_sequence_range, false, start));
    EXPECT_FALSE(reached.plausible(numbered_writer(2), max_sequence_range + 1, false, start));
    EXPECT_TRUE(reached.plausible(numbered_writer(3), max_sequence_range + 1, true, start));
}

TEST(SequenceNumberGuard, LongSilenceDoesNotBlockWriter) {
    SequenceNumberGuard reached;
    EXPECT_TRUE(reached.plausible(numbered_writer(1), 20'000'000, true, start))
        << "a server that has run for long";
    EXPECT_TRUE(reached.plausible(numbered_writer(1), 19'999'990, true, start)) << "a repair";
    // 100 a second; received again after two days.
    EXPECT_TRUE(reached.plausible(numbered_writer(1), 20'000'000 + 48 * 3600 * 100, true, start + 48h));
    // 900 a second, a heartbeat each.
    for (int i = 1; i < 900 * 600; ++i) {
        ASSERT_TRUE(reached.plausible(numbered_writer(2), i, true, start + i * 1'000'000us / 900));
    }
}

// A reader counts at two million a second. Forged heartbeats of a writer must not make it count for longer
// than a moment, whatever their steps.
TEST(SequenceNumberGuard, ForgedStepsAreRateLimited) {
    SequenceNumberGuard reached;
    std::int64_t number = 1;
    ASSERT_TRUE(reached.plausible(numbered_writer(3), number, true, start));
    for (int i = 0; i < 100'000; ++i) {
        for (const std::int64_t step :
             {std::int64_t{1} << 30, max_sequence_range, std::int64_t{1000}, std::int64_t{1}}) {
            if (reached.plausible(numbered_writer(3), number + step, true, start + i * 100us)) {
                number += step;
            }
        }
    }
    EXPECT_LE(number, 1 + SequenceNumberGuard::burst + 10 * SequenceNumberGuard::per_second);
    EXPECT_GE(number, SequenceNumberGuard::burst);
}

TEST(SequenceNumberGuard, ForgedWritersDoNotEvictActiveWriter) {
    SequenceNumberGuard reached;
    ASSERT_TRUE(reached.plausible(numbered_writer(4), 5, true, start));
    for (std::uint32_t i = 0; i < 3 * SequenceNumberGuard::max_writers; ++i) {
        WriterId invented = numbered_writer(5);
        invented.participant[4] = static_cast<std::uint8_t>(i);
        invented.participant[5] = static_cast<std::uint8_t>(i >> 8);
        ASSERT_TRUE(reached.plausible(invented, 1, false, start + i * 1ms));
        ASSERT_TRUE(reached.plausible(numbered_writer(4), 5, true, start + i * 1ms));
    }
    EXPECT_FALSE(reached.plausible(numbered_writer(4), 10'000'000, true, start + 13s))
        << "it has not been forgotten";
}

}  // namespace
}  // namespace eti::bus
