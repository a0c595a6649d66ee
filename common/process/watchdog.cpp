// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/watchdog.hpp"

#include <utility>

#include "common/process/threads/priority.hpp"

namespace eti {

Watchdog::Watchdog(std::chrono::milliseconds tick, int ticks, std::function<void()> stuck)
    : tick_(tick), ticks_(ticks), stuck_(std::move(stuck)), thread_([this] { run(); }) {}

Watchdog::~Watchdog() {
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    ending_.notify_all();
    thread_.join();
}

void Watchdog::run() {
    // A hung thread with real-time priority may hold every processor; the kernel reserves a little time for
    // normal threads.
    reset_priority();
    std::array<std::uint64_t, max_calls> seen{};
    std::array<int, max_calls> since{};
    std::unique_lock lock(mutex_);
    while (!ending_.wait_for(lock, tick_, [this] { return end_; })) {
        for (std::size_t i = 0; i < max_calls; ++i) {
            const std::uint64_t call = slots_[i].load(std::memory_order_relaxed);
            since[i] = call != 0 && call == seen[i] ? since[i] + 1 : 0;
            seen[i] = call;
            if (since[i] >= ticks_) {
                stuck_();
                return;
            }
        }
    }
}

Watchdog::Call::Call(Watchdog& watch) {
    const std::uint64_t call = watch.calls_.fetch_add(1, std::memory_order_relaxed) + 1;
    for (auto& slot : watch.slots_) {
        std::uint64_t none = 0;
        if (slot.compare_exchange_strong(none, call, std::memory_order_relaxed)) {
            slot_ = &slot;
            return;
        }
    }
}

Watchdog::Call::~Call() {
    if (slot_ != nullptr) {
        slot_->store(0, std::memory_order_relaxed);
    }
}

}  // namespace eti
