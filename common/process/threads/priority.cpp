// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/threads/priority.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace eti {

namespace {

std::string take_priority(int policy, int priority) {
    sched_param parameters{};
    parameters.sched_priority = priority;
    if (::sched_setscheduler(0, policy, &parameters) == 0) {
        return {};
    }
    return fmt::format(
        "no real-time priority ({}): messages and forces may be late under load; run as root, or allow it: "
        "ulimit -r {}",
        std::strerror(errno), priority);
}

}  // namespace

std::string set_real_time_priority(int priority) {
    return take_priority(SCHED_FIFO | SCHED_RESET_ON_FORK, priority);
}

ThreadId this_thread_id() {
    return ::gettid();
}

bool set_thread_priority(ThreadId thread, int priority) {
    sched_param parameters{};
    parameters.sched_priority = priority;
    // Only with a privilege could the flag be cleared again.
    const int policy = (priority > 0 ? SCHED_FIFO : SCHED_OTHER) | SCHED_RESET_ON_FORK;
    return ::sched_setscheduler(thread, policy, &parameters) == 0;
}

void reset_priority() {
    const sched_param none{};
    ::sched_setscheduler(0, SCHED_OTHER, &none);
}

RealTimeThreads::RealTimeThreads(int priority, bool wanted)
    : wanted_(wanted), refusal_(wanted ? take_priority(SCHED_FIFO, priority) : std::string()) {}

RealTimeThreads::~RealTimeThreads() {
    if (wanted_) {
        reset_priority();
    }
}

void lower_priority(int nice) {
    ::setpriority(PRIO_PROCESS, 0, std::max(nice, ::getpriority(PRIO_PROCESS, 0)));
}

}  // namespace eti
