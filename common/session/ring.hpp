// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

namespace eti::session {

/// Bounded queue between one producing and one consuming thread; neither ever waits. Slots are
/// assigned to, not constructed anew, so that records which own memory keep it: no allocation once
/// every slot was used.
template <class T>
class Ring {
  public:
    explicit Ring(std::size_t capacity) : slots_(capacity + 1) {}

    [[nodiscard]] std::size_t capacity() const { return slots_.size() - 1; }

    /// Producer. False when full.
    [[nodiscard]] bool push(const T& value) {
        const std::size_t head = head_.load(std::memory_order_relaxed);
        const std::size_t next = after(head);
        if (next == tail_.load(std::memory_order_acquire)) {
            return false;
        }
        slots_[head] = value;
        head_.store(next, std::memory_order_release);
        return true;
    }

    /// Consumer: the oldest value, or nothing. Valid until pop().
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
    // On cache lines of their own: the threads would otherwise take them from each other.
    alignas(64) std::atomic<std::size_t> head_{0};
    alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace eti::session
