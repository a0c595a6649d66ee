// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/triple_buffer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

namespace eti::devices {
namespace {

TEST(TripleBuffer, GivesTheNewestOnce) {
    TripleBuffer<int> buffer;
    const int* value = nullptr;
    EXPECT_FALSE(buffer.read(value));
    EXPECT_EQ(*value, 0) << "before the first write there is a value of its own";
    buffer.write(1);
    buffer.write(2);
    EXPECT_TRUE(buffer.read(value));
    EXPECT_EQ(*value, 2);
    EXPECT_FALSE(buffer.read(value));
    EXPECT_EQ(*value, 2);
    for (int i = 3; i < 20; ++i) {
        buffer.write(i);
        EXPECT_EQ(*value, i - 1) << "the writer touched what the reader holds";
        EXPECT_TRUE(buffer.read(value));
        EXPECT_EQ(*value, i);
    }
}

// A torn value would hold two different numbers; one read out of order would decrease.
TEST(TripleBuffer, ReadsAreUntornAndMonotonic) {
    constexpr std::uint64_t writes = 300'000;
    using Value = std::array<std::uint64_t, 64>;
    TripleBuffer<Value> buffer;
    std::thread writer([&] {
        Value value;
        for (std::uint64_t i = 1; i <= writes; ++i) {
            value.fill(i);
            buffer.write(value);
        }
    });
    std::uint64_t last = 0;
    const Value* value = nullptr;
    while (last < writes) {
        if (buffer.read(value)) {
            ASSERT_TRUE(std::ranges::all_of(*value, [&](std::uint64_t x) { return x == value->front(); }));
            ASSERT_GT(value->front(), last);
            last = value->front();
        }
    }
    writer.join();
}

}  // namespace
}  // namespace eti::devices
