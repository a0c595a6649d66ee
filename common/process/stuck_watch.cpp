// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/process/stuck_watch.hpp"

#include <utility>

#include "common/process/priority.hpp"

namespace eti {

StuckWatch::StuckWatch(std::chrono::milliseconds tick, int ticks, std::function<void()> stuck)
    : tick_(tick), ticks_(ticks), stuck_(std::move(stuck)), thread_([this] { run(); }) {}

StuckWatch::~StuckWatch() {
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    ending_.notify_all();
    thread_.join();
}

void StuckWatch::run() {
    // What hangs may hold every processor with a real-time priority; the kernel keeps a little for the
    // others.
    become_ordinary();
    std::array<std::uint64_t, most_inside> seen{};
    std::array<int, most_inside> since{};
    std::unique_lock lock(mutex_);
    while (!ending_.wait_for(lock, tick_, [this] { return end_; })) {
        for (std::size_t i = 0; i < most_inside; ++i) {
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

StuckWatch::Call::Call(StuckWatch& watch) {
    const std::uint64_t call = watch.calls_.fetch_add(1, std::memory_order_relaxed) + 1;
    for (auto& slot : watch.slots_) {
        std::uint64_t none = 0;
        if (slot.compare_exchange_strong(none, call, std::memory_order_relaxed)) {
            slot_ = &slot;
            return;
        }
    }
}

StuckWatch::Call::~Call() {
    if (slot_ != nullptr) {
        slot_->store(0, std::memory_order_relaxed);
    }
}

}  // namespace eti
