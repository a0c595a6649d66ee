// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace eti::devices {

/// Wait-free hand-over of the newest value from one writing to one reading thread. Of the three slots, one
/// belongs to the writer, one to the reader, and the third holds the newest value written; a single atomic
/// exchange swaps it. Of several values written between two reads, only the last is kept.
template <class Value>
class TripleBuffer {
  public:
    /// Writer: publishes `value`.
    void write(const Value& value) {
        slots_[write_] = value;
        write_ =
            middle_.exchange(static_cast<std::uint8_t>(write_ | fresh), std::memory_order_acq_rel) & index;
    }

    /// Reader: the newest value; true if it has not been read before. The reference stays valid, and the
    /// value unchanged, until the next call.
    [[nodiscard]] bool read(const Value*& value) {
        // Only the writer sets the flag and only the reader clears it, so a plain load suffices.
        const bool is_new = (middle_.load(std::memory_order_relaxed) & fresh) != 0;
        if (is_new) {
            read_ = middle_.exchange(read_, std::memory_order_acq_rel) & index;
        }
        value = &slots_[read_];
        return is_new;
    }

  private:
    static constexpr std::uint8_t index = 3, fresh = 4;
    std::array<Value, 3> slots_{};
    // On separate cache lines, to avoid false sharing.
    alignas(64) std::atomic<std::uint8_t> middle_{1};
    alignas(64) std::uint8_t write_ = 0;
    alignas(64) std::uint8_t read_ = 2;
};

}  // namespace eti::devices
