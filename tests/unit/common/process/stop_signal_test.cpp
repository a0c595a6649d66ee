// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/stop_signal.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>

#include "common/process/guard.hpp"

namespace eti {
namespace {

/// Output of a child process that caught signals and raised this one; or the signal that ended it.
GuardedResult after(const StopSignals& how, int number, int times = 1) {
    return run_guarded([&] {
        catch_stop_signals(how);
        for (int i = 0; i < times; ++i) {
            ::raise(number);
        }
        return stop_requested() ? 7 : 8;
    });
}

TEST(StopSignal, RepeatedSigintAndSigtermAskToStop) {
    for (const int number : {SIGINT, SIGTERM}) {
        EXPECT_EQ(after({}, number).status, 7) << number;
        EXPECT_EQ(after({}, number, 3).status, 7) << number;
    }
    EXPECT_FALSE(stop_requested());
}

TEST(StopSignal, SecondSignalEndsImmediatelyIfEnabled) {
    EXPECT_EQ(after({.second_ends = true}, SIGINT).status, 7);
    EXPECT_TRUE(after({.second_ends = true}, SIGINT, 2).broken.has_value());
}

TEST(StopSignal, DeviceHolderSurvivesTerminalHangUp) {
    for (const int number : {SIGHUP, SIGQUIT}) {
        EXPECT_TRUE(after({}, number).broken.has_value()) << number;
        EXPECT_EQ(after({.holds_device = true}, number).status, 7) << number;
    }
    EXPECT_EQ(after({.holds_device = true}, SIGPIPE).status, 8);
}

TEST(StopSignal, SignalInterruptsWaitOfDeviceHolder) {
    const GuardedResult ended = run_guarded([] {
        catch_stop_signals({.holds_device = true});
        int ends[2];
        if (::pipe(ends) != 0) {
            return 1;
        }
        const pid_t parent = ::getpid();
        if (::fork() == 0) {
            ::usleep(100'000);
            ::kill(parent, SIGINT);
            ::_exit(0);
        }
        char byte = 0;
        const bool interrupted = ::read(ends[0], &byte, 1) < 0 && errno == EINTR;
        return interrupted && stop_requested() ? 7 : 8;
    });
    EXPECT_EQ(ended.status, 7);
}

}  // namespace
}  // namespace eti
