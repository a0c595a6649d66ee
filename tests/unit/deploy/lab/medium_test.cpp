// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "deploy/lab/medium.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eti::lab {
namespace {

using namespace std::chrono_literals;

constexpr Clock::time_point start{};
constexpr std::uint8_t everybody = 0xff, group = 0x01;

/// A frame from the host with this number to that one.
std::vector<std::uint8_t> frame(std::uint8_t to, std::uint8_t from, std::size_t size = 100) {
    std::vector<std::uint8_t> bytes(size);
    bytes[5] = to;
    bytes[11] = from;
    if (to == everybody) {
        std::fill_n(bytes.begin(), 6, std::uint8_t{0xff});
    }
    return bytes;
}

std::vector<std::uint8_t> to_group(std::uint8_t from) {
    auto bytes = frame(0, from);
    bytes[0] = group;
    return bytes;
}

std::vector<std::size_t> receivers(Medium& medium, Clock::time_point now) {
    std::vector<std::size_t> ports;
    while (const auto delivery = medium.next(now)) {
        ports.push_back(delivery->port);
    }
    return ports;
}

using Ports = std::vector<std::size_t>;

TEST(Medium, FloodsUntilTheHostsPortIsLearned) {
    Medium medium(std::vector<Attachment>(3), true, 1);
    medium.send(0, frame(2, 1), start);
    EXPECT_EQ(receivers(medium, start), (Ports{1, 2}));
    medium.send(1, frame(1, 2), start);
    EXPECT_EQ(receivers(medium, start), (Ports{0}));
    medium.send(0, frame(2, 1), start);
    EXPECT_EQ(receivers(medium, start), (Ports{1}));
    medium.send(0, frame(1, 1), start);
    EXPECT_TRUE(receivers(medium, start).empty()) << "to itself";
}

TEST(Medium, BlocksMulticastButNotBroadcast) {
    Medium with(std::vector<Attachment>(3), true, 1), without(std::vector<Attachment>(3), false, 1);
    with.send(0, to_group(1), start);
    EXPECT_EQ(receivers(with, start), (Ports{1, 2}));
    without.send(0, to_group(1), start);
    EXPECT_TRUE(receivers(without, start).empty());
    EXPECT_EQ(without.counts()[0].held_back, 1u);
    without.send(0, frame(everybody, 1), start);
    EXPECT_EQ(receivers(without, start), (Ports{1, 2}));
}

TEST(Medium, DelayIsThatOfTheSlowerEnd) {
    Medium medium({{.delay = 5ms}, {.delay = 20ms}, {}}, true, 1);
    medium.send(0, frame(everybody, 1), start);
    EXPECT_EQ(medium.next_at(), start + 5ms);
    EXPECT_TRUE(receivers(medium, start + 5ms - 1ns).empty());
    EXPECT_EQ(receivers(medium, start + 5ms), (Ports{2}));
    EXPECT_EQ(receivers(medium, start + 20ms), (Ports{1}));
    EXPECT_EQ(medium.next_at(), Clock::time_point::max());
}

TEST(Medium, JitterIsUniform) {
    constexpr int count = 4000;
    Medium medium({{.delay = 1ms, .jitter = 2ms}, {}}, true, 1);
    for (int i = 0; i < count; ++i) {
        medium.send(0, frame(everybody, 1), start);
    }
    EXPECT_GE(medium.next_at(), start + 1ms);
    // Half of them arrive later than the median, within four standard deviations of a binomial.
    EXPECT_NEAR(static_cast<double>(receivers(medium, start + 2ms).size()), count / 2,
                4 * std::sqrt(count * 0.25));
    (void)receivers(medium, start + 3ms);
    EXPECT_EQ(medium.next_at(), Clock::time_point::max());
}

TEST(Medium, LossIsIndependentPerReceiver) {
    constexpr int count = 20000;
    constexpr double loss = 0.05;
    Medium medium({{}, {.loss = loss}, {.loss = loss}}, true, 7);
    int alone = 0;
    for (int i = 0; i < count; ++i) {
        medium.send(0, frame(everybody, 1), start);
        alone += receivers(medium, start).size() == 1 ? 1 : 0;
    }
    const auto scatter = [](double share) { return 4.0 * std::sqrt(count * share * (1.0 - share)); };
    EXPECT_NEAR(static_cast<double>(medium.counts()[1].lost), count * loss, scatter(loss));
    EXPECT_NEAR(static_cast<double>(medium.counts()[2].lost), count * loss, scatter(loss));
    const double one = 2 * loss * (1 - loss);
    EXPECT_NEAR(alone, count * one, scatter(one));
}

TEST(Medium, LossIsReproducibleFromTheSeed) {
    Medium a({{.loss = 0.5}, {}}, true, 3), b({{.loss = 0.5}, {}}, true, 3);
    for (int i = 0; i < 64; ++i) {
        a.send(0, frame(everybody, 1), start);
        b.send(0, frame(everybody, 1), start);
        EXPECT_EQ(receivers(a, start), receivers(b, start));
    }
}

TEST(Medium, ALimitedRateQueuesThenDrops) {
    // 1000 bytes take 1 ms up and, where the receiver's line has the same rate, 1 ms down.
    constexpr double rate = 8e6;
    Medium medium({{.rate = rate}, {.rate = rate}}, true, 1);
    for (int i = 0; i < 200; ++i) {
        medium.send(0, frame(everybody, 1, 1000), start);
    }
    EXPECT_EQ(medium.next_at(), start + 2ms);
    // A frame that would wait longer than 100 ms is dropped.
    EXPECT_EQ(medium.counts()[0].overflowed, 200u - 101u);
    EXPECT_EQ(receivers(medium, start + 1s).size(), 101u);
    EXPECT_EQ(medium.counts()[1].bytes_received, 101'000u);
}

TEST(Medium, DropsInvalidFrames) {
    Medium medium(std::vector<Attachment>(2), true, 1);
    medium.send(0, std::vector<std::uint8_t>(13), start);
    EXPECT_EQ(medium.counts()[0].frames_sent, 0u);
}

}  // namespace
}  // namespace eti::lab
