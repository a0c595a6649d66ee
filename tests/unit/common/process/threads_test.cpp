// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <thread>

#include "common/process/threads/mailbox.hpp"
#include "common/process/threads/spsc_queue.hpp"

namespace eti {
namespace {

TEST(Mailbox, GivesTheNewestOnce) {
    Mailbox<int> box;
    const int* value = nullptr;
    EXPECT_FALSE(box.read(value));
    EXPECT_EQ(*value, 0) << "before the first write there is a value of its own";
    EXPECT_FALSE(box.write(1));
    EXPECT_TRUE(box.write(2)) << "the first was never read";
    EXPECT_TRUE(box.read(value));
    EXPECT_EQ(*value, 2);
    EXPECT_FALSE(box.read(value));
    EXPECT_EQ(*value, 2);
    for (int i = 3; i < 20; ++i) {
        EXPECT_FALSE(box.write(i));
        EXPECT_EQ(*value, i - 1) << "the writer touched what the reader holds";
        EXPECT_TRUE(box.read(value));
        EXPECT_EQ(*value, i);
    }
}

// A torn value would hold two different numbers; one read out of order would decrease.
TEST(Mailbox, ReadsAreUntornAndMonotonic) {
    constexpr std::uint64_t writes = 300'000;
    using Value = std::array<std::uint64_t, 64>;
    Mailbox<Value> box;
    std::thread writer([&] {
        Value value;
        for (std::uint64_t i = 1; i <= writes; ++i) {
            value.fill(i);
            box.write(value);
        }
    });
    std::uint64_t last = 0;
    const Value* value = nullptr;
    while (last < writes) {
        if (box.read(value)) {
            ASSERT_TRUE(std::ranges::all_of(*value, [&](std::uint64_t x) { return x == value->front(); }));
            ASSERT_GT(value->front(), last);
            last = value->front();
        }
    }
    writer.join();
}

TEST(SpscQueue, PassesEveryValueInOrder) {
    SpscQueue<std::uint64_t> queue(7);
    constexpr std::uint64_t count = 200000;
    std::thread producer([&] {
        for (std::uint64_t i = 0; i < count;) {
            i += queue.push(i) ? 1 : 0;
        }
    });
    for (std::uint64_t expected = 0; expected < count;) {
        if (const std::uint64_t* value = queue.front()) {
            ASSERT_EQ(*value, expected);
            queue.pop();
            ++expected;
        }
    }
    producer.join();
    EXPECT_EQ(queue.front(), nullptr);
}

TEST(SpscQueue, HoldsItsCapacityAndNoMore) {
    SpscQueue<int> queue(3);
    EXPECT_TRUE(queue.push(1) && queue.push(2) && queue.push(3));
    EXPECT_FALSE(queue.push(4));
    queue.pop();
    EXPECT_TRUE(queue.push(5));
    EXPECT_EQ(*queue.front(), 2);
}

}  // namespace
}  // namespace eti
