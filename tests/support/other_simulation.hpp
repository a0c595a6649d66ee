// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "common/process/threads/processor_share.hpp"

namespace eti::test {

/// A process that announces a simulation, until it is killed.
class OtherSimulation {
  public:
    /// `on`: the only processor that it may run on.
    explicit OtherSimulation(std::optional<int> on = {}) {
        int ready[2];
        EXPECT_EQ(::pipe(ready), 0);
        pid_ = ::fork();
        if (pid_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            if (on) {
                restrict_to(*on);
            }
            const ProcessorShare share;
            (void)!::write(ready[1], "x", 1);
            for (;;) {
                ::pause();
            }
        }
        char byte = 0;
        EXPECT_EQ(::read(ready[0], &byte, 1), 1);
        ::close(ready[0]);
        ::close(ready[1]);
    }
    ~OtherSimulation() { kill(); }
    OtherSimulation(const OtherSimulation&) = delete;
    OtherSimulation& operator=(const OtherSimulation&) = delete;

    void kill() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            ::waitpid(pid_, nullptr, 0);
            pid_ = 0;
        }
    }
    static void restrict_to(int processor) {
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(processor, &one);
        EXPECT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    }

  private:
    pid_t pid_ = 0;
};

}  // namespace eti::test
