// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/threads/priority.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <thread>

#include "common/process/guard.hpp"

namespace eti {
namespace {

struct Scheduling {
    int policy = -1;
    int priority = -1;
    bool operator==(const Scheduling&) const = default;
};

Scheduling scheduling() {
    sched_param parameters{};
    ::sched_getparam(0, &parameters);
    return {::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK, parameters.sched_priority};
}

Scheduling scheduling_of_a_new_thread() {
    Scheduling found;
    std::thread([&] { found = scheduling(); }).join();
    return found;
}

constexpr Scheduling ordinary{SCHED_OTHER, 0};

TEST(Priority, RealTimeAppliesToCallingThreadOnly) {
    std::thread([] {
        if (const std::string refusal = set_real_time_priority(priority::step); !refusal.empty()) {
            GTEST_SKIP() << refusal;
        }
        EXPECT_EQ(scheduling(), (Scheduling{SCHED_FIFO, priority::step}));
        EXPECT_EQ(scheduling_of_a_new_thread(), ordinary);
        reset_priority();
        EXPECT_EQ(scheduling(), ordinary);
    }).join();
    EXPECT_EQ(scheduling(), ordinary);
}

TEST(Priority, ScopeGivesNewThreadsRealTimePriority) {
    std::thread([] {
        {
            const RealTimeThreads real_time(priority::bus);
            if (!real_time.refusal().empty()) {
                GTEST_SKIP() << real_time.refusal();
            }
            EXPECT_EQ(scheduling_of_a_new_thread(), (Scheduling{SCHED_FIFO, priority::bus}));
        }
        EXPECT_EQ(scheduling(), ordinary);
        EXPECT_EQ(scheduling_of_a_new_thread(), ordinary);
    }).join();
}

TEST(Priority, RefusalNamesTheRemedy) {
    const GuardedResult tried = run_guarded([] {
        const rlimit none{0, 0};
        ::setrlimit(RLIMIT_RTPRIO, &none);
        if (::geteuid() == 0 && ::setuid(65534) != 0) {
            return 2;
        }
        const std::string refusal = set_real_time_priority(priority::bus);
        const bool told = refusal.find("Operation not permitted") != std::string::npos &&
                          refusal.find("ulimit -r 70") != std::string::npos &&
                          refusal.find('\n') == std::string::npos;
        return told && scheduling() == ordinary ? 0 : 1;
    });
    EXPECT_FALSE(tried.broken) << *tried.broken;
    EXPECT_EQ(tried.status, 0);
}

int nice_of_a_new_thread() {
    int found = 0;
    std::thread([&] { found = ::getpriority(PRIO_PROCESS, 0); }).join();
    return found;
}

TEST(Priority, LoweringPriorityNeedsNoPrivilege) {
    const int before = ::getpriority(PRIO_PROCESS, 0);
    std::thread([&] {
        lower_priority(5);
        EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), std::max(5, before));
        EXPECT_EQ(nice_of_a_new_thread(), std::max(5, before));
    }).join();
    EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), before);
}

}  // namespace
}  // namespace eti
