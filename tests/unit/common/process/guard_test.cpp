// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/guard.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include "common/process/stop_signal.hpp"

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

/// Asks this process to end while it waits for the task.
GuardedResult stopped_while(const std::function<int()>& task) {
    catch_stop_signals();
    std::thread user([] {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        ::kill(::getpid(), SIGTERM);
    });
    const GuardedResult ended = run_guarded(task, {.processor_seconds = 20});
    user.join();
    request_stop(false);
    ::signal(SIGTERM, SIG_DFL);
    ::signal(SIGINT, SIG_DFL);
    return ended;
}

TEST(Guard, StopEndsATaskThatDoesNotPoll) {
    const GuardedResult ended = stopped_while([] {
        end_at_once_on_stop();
        for (std::atomic<bool> never{false}; !never;) {
        }
        return 0;
    });
    EXPECT_TRUE(ended.stopped);
    EXPECT_EQ(ended.status, status_stopped);
    EXPECT_FALSE(ended.broken) << *ended.broken;
}

TEST(Guard, StopIsPassedToATaskThatPolls) {
    const GuardedResult ended = stopped_while([] {
        while (!stop_requested()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return 7;
    });
    EXPECT_EQ(ended.status, 7);
    EXPECT_FALSE(ended.stopped);
    EXPECT_FALSE(ended.broken);
}

}  // namespace
}  // namespace eti
