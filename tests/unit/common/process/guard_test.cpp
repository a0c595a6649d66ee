// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/guard.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <csignal>

namespace eti {
namespace {

TEST(Guard, DistinguishesResultsFromCrashes) {
    EXPECT_EQ(run_guarded([] { return 7; }).status, 7);
    EXPECT_FALSE(run_guarded([] { return 7; }).broken);
    const GuardedResult crashed = run_guarded([] {
        ::raise(SIGKILL);
        return 0;
    });
    ASSERT_TRUE(crashed.broken);
    EXPECT_NE(crashed.broken->find("signal 9"), std::string::npos) << *crashed.broken;
}

TEST(Guard, EndsATaskThatHangs) {
    const GuardedResult hung = run_guarded(
        [] {
            for (std::atomic<bool> never{false}; !never;) {
            }
            return 0;
        },
        {.processor_seconds = 1});
    EXPECT_TRUE(hung.broken);
}

}  // namespace
}  // namespace eti
