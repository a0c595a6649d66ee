// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace eti::bus {

using Bytes = std::span<const std::uint8_t>;

/// Reads a submessage's numbers in its byte order. Past the end it reads zeros; nothing is left, and whole()
/// is false from then on.
class Reader {
  public:
    Reader(Bytes bytes, bool little) : bytes_(bytes), little_(little) {}

    std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    /// A sequence number: high word first, whatever the byte order.
    std::int64_t sequence_number() {
        const auto high = static_cast<std::int32_t>(u32());
        return (static_cast<std::int64_t>(high) << 32) | u32();
    }
    template <std::size_t Size>
    std::array<std::uint8_t, Size> octets() {
        std::array<std::uint8_t, Size> out{};
        if (take(Size)) {
            std::ranges::copy(bytes_.subspan(at_ - Size, Size), out.begin());
        }
        return out;
    }
    void skip(std::size_t count) { (void)take(count); }
    /// Skips to the next multiple of four bytes from the start.
    void align() { skip((4 - at_ % 4) % 4); }
    [[nodiscard]] Bytes rest() const { return bytes_.subspan(at_); }
    [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
    [[nodiscard]] bool whole() const { return whole_; }

  private:
    bool take(std::size_t count) {
        whole_ = whole_ && count <= left();
        at_ = whole_ ? at_ + count : bytes_.size();
        return whole_;
    }
    std::uint64_t number(std::size_t size) {
        std::uint64_t value = 0;
        if (take(size)) {
            for (std::size_t i = 0; i < size; ++i) {
                value |= static_cast<std::uint64_t>(bytes_[at_ - size + i])
                         << (8 * (little_ ? i : size - 1 - i));
            }
        }
        return value;
    }

    Bytes bytes_;
    std::size_t at_ = 0;
    bool little_, whole_ = true;
};

}  // namespace eti::bus
