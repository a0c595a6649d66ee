// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/step_priority.hpp"

#include <spdlog/spdlog.h>

namespace eti::app {

StepPriority::StepPriority(bool wanted) : wanted_(wanted) {
    if (!wanted_) {
        return;
    }
    granted_ = set_real_time_priority(priority::step).empty();
    threads_.push_back(this_thread_id());
    workers_.emplace([this] { add_worker(); });
}

StepPriority::~StepPriority() {
    if (wanted_) {
        workers_.reset();
        reset_priority();
    }
}

void StepPriority::add_worker() {
    const std::lock_guard lock(mutex_);
    threads_.push_back(this_thread_id());
    (void)set_thread_priority(threads_.back(), priority_);
}

void StepPriority::set_all(int priority) {
    const std::lock_guard lock(mutex_);
    priority_ = priority;
    // A worker that has ended meanwhile is no thread any more, which is no fault.
    std::erase_if(threads_, [&](ThreadId thread) { return !set_thread_priority(thread, priority); });
}

void StepPriority::update(bool late) {
    if (!granted_) {
        return;
    }
    switch (policy_.update(late, PriorityPolicy::Clock::now())) {
        case PriorityPolicy::Change::yield:
            set_all(ordinary_priority);
            if (!std::exchange(told_, true)) {
                spdlog::warn(
                    "the simulation cannot keep up and gives way: it runs at ordinary priority until it has "
                    "kept time for {} s, so that devices and clients on this machine are not starved. "
                    "Remedy: "
                    "close other programs, run clients on another machine, or choose a coarser scenario",
                    PriorityPolicy::shortest_time_kept.count());
            }
            break;
        case PriorityPolicy::Change::resume:
            set_all(priority::step);
            if (!std::exchange(told_back_, true)) {
                spdlog::info("the simulation keeps time and has its real-time priority back");
            }
            break;
        case PriorityPolicy::Change::none:
            break;
    }
}

}  // namespace eti::app
