// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

namespace eti {

/// Bounded queue from one producing to one consuming thread; neither ever waits. Slots are assigned, not
/// reconstructed, so values keep their memory: no allocation once every slot has been used.
template <class T>
class SpscQueue {
  public:
    explicit SpscQueue(std::size_t capacity) : slots_(capacity + 1) {}

    [[nodiscard]] std::size_t capacity() const { return slots_.size() - 1; }

    /// Producer: the slot to fill before push(), or nullptr when the queue is full.
    [[nodiscard]] T* back() {
        const std::size_t head = head_.load(std::memory_order_relaxed);
        return after(head) == tail_.load(std::memory_order_acquire) ? nullptr : &slots_[head];
    }
    void push() { head_.store(after(head_.load(std::memory_order_relaxed)), std::memory_order_release); }

    /// Producer. False when full.
    [[nodiscard]] bool push(const T& value) {
        T* const slot = back();
        if (slot != nullptr) {
            *slot = value;
            push();
        }
        return slot != nullptr;
    }

    /// Consumer: the oldest value, or nullptr. Valid until pop().
    [[nodiscard]] const T* front() const {
        const std::size_t tail = tail_.load(std::memory_order_relaxed);
        return tail == head_.load(std::memory_order_acquire) ? nullptr : &slots_[tail];
    }
    void pop() { tail_.store(after(tail_.load(std::memory_order_relaxed)), std::memory_order_release); }

  private:
    [[nodiscard]] std::size_t after(std::size_t index) const {
        return index + 1 == slots_.size() ? 0 : index + 1;
    }

    std::vector<T> slots_;
    // On separate cache lines, to avoid false sharing.
    alignas(64) std::atomic<std::size_t> head_{0};
    alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace eti
