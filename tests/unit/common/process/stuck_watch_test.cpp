// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/stuck_watch.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace eti {
namespace {

using namespace std::chrono_literals;

TEST(StuckWatch, CallsThatComeBackAreNotStuck) {
    std::atomic<int> stuck{0};
    StuckWatch watch(2ms, 20, [&] { ++stuck; });
    const auto end = std::chrono::steady_clock::now() + 200ms;
    int held_up = 0;  // by other programs, for nearly as long as makes a call a stuck one
    while (std::chrono::steady_clock::now() < end) {
        const auto begin = std::chrono::steady_clock::now();
        {
            const StuckWatch::Call outer(watch);
            for (int i = 0; i < 100; ++i) {
                const StuckWatch::Call inner(watch);
            }
        }
        held_up += std::chrono::steady_clock::now() - begin > 30ms ? 1 : 0;
        std::this_thread::sleep_for(100us);
    }
    EXPECT_LE(stuck, held_up);
}

TEST(StuckWatch, ACallThatDoesNotComeBackIsToldOnce) {
    std::atomic<int> stuck{0};
    StuckWatch watch(2ms, 5, [&] { ++stuck; });
    const StuckWatch::Call call(watch);
    const auto start = std::chrono::steady_clock::now();
    while (stuck == 0 && std::chrono::steady_clock::now() - start < 120s) {
        std::this_thread::sleep_for(1ms);
    }
    EXPECT_GE(std::chrono::steady_clock::now() - start, 10ms) << "not before its time";
    std::this_thread::sleep_for(50ms);
    EXPECT_EQ(stuck, 1);
}

TEST(StuckWatch, MoreCallsThanItHasPlacesForDoNoHarm) {
    StuckWatch watch(1ms, 3600'000, [] {});
    std::vector<std::unique_ptr<StuckWatch::Call>> calls;
    for (int i = 0; i < 100; ++i) {
        calls.push_back(std::make_unique<StuckWatch::Call>(watch));
    }
}

}  // namespace
}  // namespace eti
