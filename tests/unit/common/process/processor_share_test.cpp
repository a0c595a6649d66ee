// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/threads/processor_share.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "common/process/threads/processors.hpp"
#include "tests/support/other_simulation.hpp"

namespace eti {
namespace {

/// Processors that this process may run on.
std::vector<int> allowed() {
    cpu_set_t set;
    std::vector<int> found;
    if (::sched_getaffinity(0, sizeof set, &set) == 0) {
        for (int i = 0; i < CPU_SETSIZE; ++i) {
            if (CPU_ISSET(i, &set)) {
                found.push_back(i);
            }
        }
    }
    return found;
}

// Other sessions may run on this machine during the tests, so counts are compared with those of before.
TEST(ProcessorShare, OthersCountUntilTheyEnd) {
    const unsigned before = ProcessorShare::simulations();
    const ProcessorShare own;
    EXPECT_EQ(ProcessorShare::simulations(), before) << "this process counts once, announced or not";
    test::OtherSimulation first, second;
    EXPECT_EQ(ProcessorShare::simulations(), before + 2);
    EXPECT_EQ(ProcessorShare::processors(), std::max(1u, usable_processors() / (before + 2)));
    first.kill();
    EXPECT_EQ(ProcessorShare::simulations(), before + 1) << "a killed one leaves nothing behind";
}

TEST(ProcessorShare, OthersOnOtherProcessorsDoNotCount) {
    const std::vector<int> processors = allowed();
    if (processors.size() < 2) {
        GTEST_SKIP() << "needs two processors";
    }
    const unsigned before = ProcessorShare::simulations();
    const test::OtherSimulation there(processors[0]);
    EXPECT_EQ(ProcessorShare::simulations(), before + 1);
    std::thread([&] {
        test::OtherSimulation::restrict_to(processors[1]);
        const unsigned apart = ProcessorShare::simulations();
        test::OtherSimulation::restrict_to(processors[0]);
        EXPECT_EQ(ProcessorShare::simulations(), apart + 1);
    }).join();
}

}  // namespace
}  // namespace eti
