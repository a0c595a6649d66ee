// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace eti::devices {

/// Hands the newest value from one writing thread to one reading thread; neither ever waits. Of the
/// three slots one is the writer's, one the reader's, and the third holds the newest value written:
/// a single atomic exchange trades it. Values written between two reads are lost but for the last.
template <class Value>
class TripleBuffer {
  public:
    /// Writer: makes `value` the newest.
    void write(const Value& value) {
        slots_[write_] = value;
        write_ =
            middle_.exchange(static_cast<std::uint8_t>(write_ | fresh), std::memory_order_acq_rel) & index;
    }

    /// Reader: the newest value; true when it was not read before. The reference stays valid, and the
    /// value unchanged, until the next call.
    [[nodiscard]] bool read(const Value*& value) {
        // Only the writer sets the flag and only the reader clears it, so a plain look decides.
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
    // Each side's slot on its own cache line, away from the other's.
    alignas(64) std::atomic<std::uint8_t> middle_{1};
    alignas(64) std::uint8_t write_ = 0;
    alignas(64) std::uint8_t read_ = 2;
};

}  // namespace eti::devices
