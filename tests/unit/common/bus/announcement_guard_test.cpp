// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Reference: what Fast DDS 2.9.1 believes of announcements that anyone can send (PDPListener,
// CVE-2023-50257).
#include "common/bus/guard/announcement_guard.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace eti::bus {
namespace {

using namespace std::chrono_literals;

const AnnouncementGuard::Clock::time_point announced{1h};
const std::vector<std::uint8_t> first = {1, 2, 3, 4}, other = {1, 2, 3, 5};

ParticipantId participant(std::uint32_t n) {
    return {1, 15, static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(n >> 8)};
}

TEST(AnnouncementGuard, FirstAnnouncementStandsWhileRepeated) {
    AnnouncementGuard guard;
    for (auto now = announced; now < announced + 60s; now += 500ms) {
        EXPECT_TRUE(guard.plausible(participant(1), {first}, now));
        EXPECT_FALSE(guard.plausible(participant(1), {other}, now)) << "other addresses, or another lease";
        EXPECT_TRUE(guard.plausible(participant(2), {other}, now));
    }
}

TEST(AnnouncementGuard, SilentParticipantMayChange) {
    AnnouncementGuard guard;
    ASSERT_TRUE(guard.plausible(participant(1), {first}, announced));
    const auto later = announced + AnnouncementGuard::stands_for;
    EXPECT_FALSE(guard.plausible(participant(1), {other}, later - 1ms));
    EXPECT_TRUE(guard.plausible(participant(1), {other}, later)) << "refused ones keep nothing alive";
    EXPECT_FALSE(guard.plausible(participant(1), {first}, later));
}

// docs/security.md: the guard cannot tell who of two is the participant, only who was first.
TEST(AnnouncementGuard, ForgerWhoSpeaksFirstShutsOutOwner) {
    AnnouncementGuard guard;
    ASSERT_TRUE(guard.plausible(participant(1), {other}, announced)) << "forged";
    for (auto now = announced; now < announced + 60s; now += 500ms) {
        EXPECT_FALSE(guard.plausible(participant(1), {first}, now));
        EXPECT_TRUE(guard.plausible(participant(1), {other}, now)) << "forged";
    }
    const auto given_up = announced + 60s + AnnouncementGuard::stands_for;
    EXPECT_TRUE(guard.plausible(participant(1), {first}, given_up)) << "only while the forger goes on";
}

TEST(AnnouncementGuard, GoodbyeIsRefused) {
    AnnouncementGuard guard;
    EXPECT_FALSE(guard.plausible(participant(1), {.content = first, .goodbye = true}, announced));
    ASSERT_TRUE(guard.plausible(participant(1), {first}, announced));
    EXPECT_FALSE(guard.plausible(participant(1), {.content = {}, .goodbye = true}, announced));
    EXPECT_TRUE(guard.plausible(participant(1), {first}, announced));
}

TEST(AnnouncementGuard, AnnouncementOfAnotherIsRefused) {
    AnnouncementGuard guard;
    EXPECT_FALSE(guard.plausible(participant(1), {.content = first, .of_another = true}, announced));
}

TEST(AnnouncementGuard, ManyStrangersDoNotGrowIt) {
    AnnouncementGuard guard;
    ASSERT_TRUE(guard.plausible(participant(1), {first}, announced));
    for (std::uint32_t i = 2; i < 2 + AnnouncementGuard::max_participants; ++i) {
        ASSERT_TRUE(guard.plausible(participant(i), {first}, announced + std::chrono::milliseconds(i)));
    }
    EXPECT_TRUE(guard.plausible(participant(1), {other}, announced + 1s)) << "forgotten";
}

}  // namespace
}  // namespace eti::bus
