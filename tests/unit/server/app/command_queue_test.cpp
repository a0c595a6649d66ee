// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/commands/command_queue.hpp"

#include <gtest/gtest.h>

#include <string>

namespace eti::app {
namespace {

using namespace std::chrono_literals;

constexpr bus::ParticipantId alice{1}, bob{2};

ReceivedCommand command(const std::string& name, float value, std::uint32_t id = 0) {
    return {"someone", id, name, value};
}

class CommandQueueTest : public testing::Test {
  protected:
    CommandQueue queue_;
    CommandQueue::Clock::time_point start_ = CommandQueue::Clock::now();
};

TEST_F(CommandQueueTest, DeliversCommandsInOrder) {
    ASSERT_TRUE(queue_.put(alice, command("b", 1.0f)));
    ASSERT_TRUE(queue_.put(bob, command("a", 2.0f)));
    ASSERT_TRUE(queue_.put(alice, command("a", 3.0f)));
    const auto due = queue_.take_due(start_);
    ASSERT_EQ(due.size(), 3u);
    EXPECT_EQ(due[0].value, 1.0f);
    EXPECT_EQ(due[1].value, 2.0f);
    EXPECT_EQ(due[2].value, 3.0f);
    EXPECT_TRUE(queue_.take_due(start_).empty());
}

// 10,000 a second for two seconds: 20 at once and 20 a second pass, and the last one takes effect.
TEST_F(CommandQueueTest, FloodIsThrottledAndKeepsLastValue) {
    std::size_t done = 0, answered = 0;
    float last = -1.0f;
    for (int step = 0; step < 360; ++step) {
        const auto now = start_ + step * 5556us;
        for (int i = 0; i < 56; ++i) {
            ASSERT_TRUE(queue_.put(alice, command("tongue_scale", static_cast<float>(step * 56 + i))));
        }
        for (const ReceivedCommand& due : queue_.take_due(now)) {
            ++done;
            last = due.value;
        }
        answered += queue_.take_replaced(now).size();
    }
    EXPECT_GE(done, 55u);
    EXPECT_LE(done, 60u);
    EXPECT_LE(answered, 60u);
    for (const ReceivedCommand& due : queue_.take_due(start_ + 3s)) {
        last = due.value;
    }
    EXPECT_EQ(last, 360.0f * 56.0f - 1.0f);
    std::string who;
    EXPECT_GT(queue_.take_replaced_count(who), 10'000u);
}

TEST_F(CommandQueueTest, FloodDoesNotDelayOtherSenders) {
    for (int i = 0; i < 1000; ++i) {
        (void)queue_.put(alice, command("kind" + std::to_string(i), 0.0f));
    }
    ASSERT_TRUE(queue_.put(bob, command("stop", 0.0f)));
    const auto due = queue_.take_due(start_);
    EXPECT_EQ(due.size(), static_cast<std::size_t>(CommandQueue::per_second) + 1);
    EXPECT_EQ(due.back().name, "stop");
}

TEST_F(CommandQueueTest, SenderCountIsBounded) {
    for (std::uint8_t i = 0; i < CommandQueue::max_senders; ++i) {
        ASSERT_TRUE(queue_.put({i, 7}, command("a", 0.0f)));
    }
    EXPECT_FALSE(queue_.put({200}, command("a", 0.0f))) << "all the others wait for something";
    (void)queue_.take_due(start_);
    EXPECT_TRUE(queue_.put({200}, command("a", 0.0f)));
}

TEST(SenderRateLimiter, LimitsEachSenderSeparately) {
    SenderRateLimiter allowed(5.0);
    const auto now = RateLimiter::Clock::now();
    for (int i = 0; i < 5; ++i) {
        EXPECT_TRUE(allowed.try_acquire(alice, now));
    }
    EXPECT_FALSE(allowed.try_acquire(alice, now));
    EXPECT_TRUE(allowed.try_acquire(bob, now));
    EXPECT_TRUE(allowed.try_acquire(alice, now + 200ms)) << "five a second";
    EXPECT_FALSE(allowed.try_acquire(alice, now + 210ms));
}

}  // namespace
}  // namespace eti::app
