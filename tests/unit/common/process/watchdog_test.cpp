// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/watchdog.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace eti {
namespace {

using namespace std::chrono_literals;

TEST(Watchdog, ReturningCallsAreNotStuck) {
    std::atomic<int> stuck{0};
    Watchdog watch(2ms, 20, [&] { ++stuck; });
    const auto end = std::chrono::steady_clock::now() + 200ms;
    int held_up = 0;  // by other programs, for nearly the time after which a call counts as stuck
    while (std::chrono::steady_clock::now() < end) {
        const auto begin = std::chrono::steady_clock::now();
        {
            const Watchdog::Call outer(watch);
            for (int i = 0; i < 100; ++i) {
                const Watchdog::Call inner(watch);
            }
        }
        held_up += std::chrono::steady_clock::now() - begin > 30ms ? 1 : 0;
        std::this_thread::sleep_for(100us);
    }
    EXPECT_LE(stuck, held_up);
}

TEST(Watchdog, StuckCallIsReportedOnce) {
    std::atomic<int> stuck{0};
    Watchdog watch(2ms, 5, [&] { ++stuck; });
    const Watchdog::Call call(watch);
    const auto start = std::chrono::steady_clock::now();
    while (stuck == 0 && std::chrono::steady_clock::now() - start < 120s) {
        std::this_thread::sleep_for(1ms);
    }
    EXPECT_GE(std::chrono::steady_clock::now() - start, 10ms) << "not before its time";
    std::this_thread::sleep_for(50ms);
    EXPECT_EQ(stuck, 1);
}

// A hundred calls at once fill all 64 slots. Were one slot not released, the rounds would use up all of them,
// and the last call would not be watched.
TEST(Watchdog, CallsBeyondCapacityReleaseTheirSlots) {
    std::atomic<int> stuck{0};
    Watchdog watch(2ms, 1000, [&] { ++stuck; });
    for (int round = 0; round < 100; ++round) {
        std::vector<std::unique_ptr<Watchdog::Call>> calls;
        for (int i = 0; i < 100; ++i) {
            calls.push_back(std::make_unique<Watchdog::Call>(watch));
        }
    }
    EXPECT_EQ(stuck, 0);
    const Watchdog::Call call(watch);
    const auto start = std::chrono::steady_clock::now();
    while (stuck == 0 && std::chrono::steady_clock::now() - start < 120s) {
        std::this_thread::sleep_for(1ms);
    }
    EXPECT_EQ(stuck, 1);
}

}  // namespace
}  // namespace eti
