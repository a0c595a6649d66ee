// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace eti {

/// Hand-over of the newest value from one writing to one reading thread (a triple buffer); neither ever
/// waits. Of the three slots, one belongs to the writer, one to the reader, and the third holds the newest
/// value posted; a single atomic exchange swaps it. Of several values posted between two reads, only the last
/// is kept. Slots are assigned, not reconstructed, so values keep their memory.
template <class Value>
class Mailbox {
  public:
    /// Writer: the slot to fill before post(). It holds an older value, or an unread one.
    [[nodiscard]] Value& draft() { return slots_[write_]; }

    /// Writer: posts the draft. True if it replaces a value that has not been read.
    bool post() {
        const std::uint8_t last =
            middle_.exchange(static_cast<std::uint8_t>(write_ | fresh), std::memory_order_acq_rel);
        write_ = last & index;
        return (last & fresh) != 0;
    }

    /// Writer: posts `value`.
    bool write(const Value& value) {
        draft() = value;
        return post();
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

    /// Reader: the newest value, read before or not; valid until the next call.
    [[nodiscard]] const Value& newest() {
        const Value* value = nullptr;
        (void)read(value);
        return *value;
    }

  private:
    static constexpr std::uint8_t index = 3, fresh = 4;
    std::array<Value, 3> slots_{};
    // On separate cache lines, to avoid false sharing.
    alignas(64) std::atomic<std::uint8_t> middle_{1};
    alignas(64) std::uint8_t write_ = 0;
    alignas(64) std::uint8_t read_ = 2;
};

}  // namespace eti
