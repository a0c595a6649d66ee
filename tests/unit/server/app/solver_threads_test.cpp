// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/solver_threads.hpp"

#include <gtest/gtest.h>

#include "tests/support/other_simulation.hpp"

namespace eti::app {
namespace {

std::size_t allowed() {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

TEST(SolverThreads, WantedNumberIsKept) {
    SolverThreads threads(3);
    EXPECT_EQ(allowed(), 3u);
    threads.update(SolverThreads::Clock::now() + 2 * SolverThreads::period);
    EXPECT_EQ(threads.count(), 3u);
    EXPECT_EQ(allowed(), 3u);
}

TEST(SolverThreads, ShareIsLookedAtOncePerPeriod) {
    SolverThreads threads(0);
    EXPECT_EQ(threads.count(), ProcessorShare::processors());
    EXPECT_EQ(allowed(), threads.count());
    const auto now = SolverThreads::Clock::now();
    threads.update(now);
    const unsigned before = threads.count();
    const test::OtherSimulation one, two;
    threads.update(now + SolverThreads::period / 2);
    EXPECT_EQ(threads.count(), before);
    threads.update(now + SolverThreads::period);
    EXPECT_EQ(threads.count(), ProcessorShare::processors());
    EXPECT_EQ(allowed(), threads.count());
    if (before > 1) {
        EXPECT_LT(threads.count(), before);
    }
}

}  // namespace
}  // namespace eti::app
