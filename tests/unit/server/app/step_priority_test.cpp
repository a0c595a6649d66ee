// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/step_priority.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <thread>

namespace eti::app {
namespace {

using namespace std::chrono_literals;
using Change = PriorityPolicy::Change;

constexpr int per_second = static_cast<int>(steps_per_second);

class PriorityPolicyTest : public ::testing::Test {
  protected:
    /// The changes within a number of steps, each `late` if `is_late(i)`.
    template <class Late>
    std::vector<Change> run(int steps, Late is_late) {
        std::vector<Change> changes;
        for (int i = 0; i < steps; ++i, now_ += 5555us) {
            if (const Change change = policy_.update(is_late(i), now_); change != Change::none) {
                changes.push_back(change);
            }
        }
        return changes;
    }
    static bool always(int) { return true; }
    static bool never(int) { return false; }
    /// Steps until the priority is back while time is kept.
    int steps_to_resume() {
        int steps = 0;
        for (Change change = Change::none; change == Change::none && steps < 100'000; ++steps) {
            change = policy_.update(false, now_);
            now_ += 5555us;
        }
        return steps;
    }

    PriorityPolicy policy_;
    PriorityPolicy::Clock::time_point now_{};
};

TEST_F(PriorityPolicyTest, YieldsAfterRunOfLateSteps) {
    EXPECT_TRUE(run(PriorityPolicy::late_steps_to_yield - 1, always).empty());
    EXPECT_FALSE(policy_.yielded());
    EXPECT_EQ(run(1, always), std::vector{Change::yield});
    EXPECT_TRUE(policy_.yielded());
    EXPECT_TRUE(run(3600, always).empty()) << "it stays so while it is late";
}

TEST_F(PriorityPolicyTest, BurstsOfLateStepsKeepPriority) {
    EXPECT_TRUE(run(36'000, [](int i) { return i % PriorityPolicy::late_steps_to_yield != 0; }).empty());
    EXPECT_FALSE(policy_.yielded());
}

TEST_F(PriorityPolicyTest, ResumesAfterTimeKept) {
    run(PriorityPolicy::late_steps_to_yield, always);
    EXPECT_NEAR(steps_to_resume(), 5 * per_second, 2);
    EXPECT_FALSE(policy_.yielded());
    EXPECT_TRUE(run(PriorityPolicy::late_steps_to_yield - 1, always).empty()) << "it counts anew";
}

TEST_F(PriorityPolicyTest, SingleLateStepsDoNotDelayResumption) {
    run(PriorityPolicy::late_steps_to_yield, always);
    EXPECT_EQ(run(5 * per_second + 2, [](int i) { return i % 30 == 0; }), std::vector{Change::resume});
}

TEST_F(PriorityPolicyTest, OftenLateSimulationDoesNotResume) {
    run(PriorityPolicy::late_steps_to_yield, always);
    EXPECT_TRUE(run(60 * per_second, [](int i) { return i % 10 == 0; }).empty());
}

TEST_F(PriorityPolicyTest, EachResumptionTakesTwiceAsLong) {
    for (int seconds = 5; seconds <= 80; seconds *= 2) {
        run(PriorityPolicy::late_steps_to_yield, always);
        EXPECT_NEAR(steps_to_resume(), seconds * per_second, 5) << seconds;
    }
    run(PriorityPolicy::late_steps_to_yield, always);
    EXPECT_NEAR(steps_to_resume(), 80 * per_second, 5);
}

// The threads' policies, as the kernel has them.
TEST(StepPriority, GivesWayAndTakesPriorityBack) {
    const auto scheduled = [] { return ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; };
    std::thread([&] {
        StepPriority priority(true);
        if (scheduled() != SCHED_FIFO) {
            GTEST_SKIP() << "no right to real-time priorities here";
        }
        for (int i = 0; i < PriorityPolicy::late_steps_to_yield; ++i) {
            EXPECT_EQ(scheduled(), SCHED_FIFO);
            priority.update(true);
        }
        EXPECT_EQ(scheduled(), SCHED_OTHER);
    }).join();
}

}  // namespace
}  // namespace eti::app
