// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Reference: the ways in which Fast DDS 2.9.1 reads, allocates or counts by fragments that do not belong
// together (CacheChange_t::add_fragments, StatefulReader::processDataFragMsg).
#include "common/bus/guard/fragment_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/bus/guard/security_message.hpp"

namespace eti::bus {
namespace {

using namespace std::chrono_literals;

const FragmentGuard::Clock::time_point moment{1h};
const std::vector<std::uint8_t> zeros(1 << 16);

WriterId writer(std::uint8_t n) {
    return {{1, 15, n}, {0, 0, 1, 2}};
}

Fragments fragment(std::int64_t sample_number, std::uint32_t first, std::uint16_t size,
                   std::uint32_t sample) {
    const std::uint32_t from = (first - 1) * size, to = std::min(from + size, sample);
    return {sample_number, first, 1, size, sample, Bytes(zeros).first(to - from)};
}

TEST(FragmentGuard, SampleInOrderAndRepeatedPasses) {
    FragmentGuard guard;
    for (const std::uint32_t first : {1u, 2u, 3u, 2u, 1u}) {
        EXPECT_TRUE(guard.plausible(writer(1), fragment(7, first, 1200, 3000), true, moment));
    }
    EXPECT_TRUE(guard.plausible(writer(1), fragment(8, 1, 1000, 2000), true, moment)) << "another sample";
    EXPECT_TRUE(guard.plausible(writer(2), fragment(7, 1, 100, 200), false, moment)) << "another writer";
}

TEST(FragmentGuard, FragmentsOfOtherSizesAreRefused) {
    FragmentGuard guard;
    ASSERT_TRUE(guard.plausible(writer(1), fragment(7, 1, 1200, 1 << 20), true, moment));
    EXPECT_FALSE(guard.plausible(writer(1), fragment(7, 2, 1204, 1 << 20), true, moment));
    EXPECT_FALSE(guard.plausible(writer(1), fragment(7, 2, 1200, (1 << 20) - 1), true, moment));
    EXPECT_TRUE(guard.plausible(writer(1), fragment(7, 2, 1200, 1 << 20), true, moment));
}

// Found by fuzz-library: Fast DDS 2.9.1 delivers the first fragment of a sample that has also come as a
// whole.
TEST(FragmentGuard, WholeSampleAfterItsFragmentIsRefused) {
    FragmentGuard guard;
    EXPECT_TRUE(guard.plausible(writer(1), 7)) << "no fragments yet";
    ASSERT_TRUE(guard.plausible(writer(1), fragment(7, 1, 1200, 3000), true, moment));
    EXPECT_FALSE(guard.plausible(writer(1), 7));
    EXPECT_TRUE(guard.plausible(writer(1), 8));
    EXPECT_TRUE(guard.plausible(writer(2), 7)) << "another writer";
    for (std::int64_t i = 8; i < 8 + static_cast<std::int64_t>(FragmentGuard::max_samples); ++i) {
        ASSERT_TRUE(guard.plausible(writer(1), fragment(i, 1, 64, 256), true, moment));
    }
    EXPECT_FALSE(guard.plausible(writer(1), 7)) << "forgotten";
}

TEST(FragmentGuard, ForgottenSamplesStayRefused) {
    FragmentGuard guard;
    const auto most = static_cast<std::int64_t>(FragmentGuard::max_samples);
    for (std::int64_t i = 1; i <= most + 1; ++i) {
        ASSERT_TRUE(guard.plausible(writer(1), fragment(i, 1, 64, 256), true, moment));
    }
    EXPECT_FALSE(guard.plausible(writer(1), fragment(1, 2, 128, 256), true, moment));
    EXPECT_TRUE(guard.plausible(writer(1), fragment(2, 2, 64, 256), true, moment));
}

TEST(FragmentGuard, OnlyServerSendsLargeSamples) {
    FragmentGuard guard;
    const std::uint32_t large = FragmentGuard::max_foreign_sample_bytes + 1;
    EXPECT_FALSE(guard.plausible(writer(1), fragment(1, 1, 1200, large), false, moment));
    EXPECT_TRUE(guard.plausible(writer(1), fragment(1, 1, 1200, large), true, moment));
}

TEST(FragmentGuard, DiscoveryIsNeverFragmented) {
    FragmentGuard guard;
    const WriterId participants{{1, 15, 9}, {0, 1, 0, 0xc2}};
    EXPECT_FALSE(guard.plausible(participants, fragment(2, 1, 64, 128), false, moment));
}

/// A handshake message with `holders` holders of which none follows, filled up with zeros.
std::vector<std::uint8_t> handshake(std::uint8_t holders) {
    std::vector<std::uint8_t> out(256);
    out[1] = 1;
    out[4 + 2 * 24 + 3 * 16 + 4] = holders;
    return out;
}

TEST(FragmentGuard, FragmentedHandshakeIsChecked) {
    const WriterId authentication{{1, 15, 9}, stateless_message_writer};
    const auto part = [](const std::vector<std::uint8_t>& message, std::int64_t number, std::uint32_t first) {
        return Fragments{number, first, 1, 64, 256, Bytes(message).subspan((first - 1) * 64, 64)};
    };
    const auto good = handshake(0), bad = handshake(255);
    ASSERT_TRUE(is_valid_stateless_message(good));
    ASSERT_FALSE(is_valid_stateless_message(bad));
    FragmentGuard guard;
    for (const std::uint32_t first : {3u, 1u, 2u, 4u}) {
        EXPECT_TRUE(guard.plausible(authentication, part(good, 1, first), false, moment));
    }
    for (const std::uint32_t first : {1u, 2u, 4u}) {
        EXPECT_TRUE(guard.plausible(authentication, part(bad, 2, first), false, moment)) << "incomplete";
    }
    EXPECT_TRUE(guard.plausible(authentication, part(good, 2, 2), false, moment)) << "the library has it";
    EXPECT_FALSE(guard.plausible(authentication, part(bad, 2, 3), false, moment));
    for (const std::uint32_t first : {1u, 2u, 3u, 4u}) {
        EXPECT_FALSE(guard.plausible(authentication, part(good, 2, first), false, moment)) << "mended";
    }
    Fragments two = part(good, 3, 1);
    two.count = 2;
    EXPECT_FALSE(guard.plausible(authentication, two, false, moment));
    EXPECT_FALSE(guard.plausible(authentication, fragment(4, 1, 64, FragmentGuard::max_handshake_bytes + 1),
                                 false, moment));
}

}  // namespace
}  // namespace eti::bus
