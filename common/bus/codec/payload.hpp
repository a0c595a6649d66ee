// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace eti::bus {

/// Steps over a serialised sample (XCDR1, OMG DDS-XTypes 1.3, 7.4.3) without allocating. A step returns false
/// when the bytes end or exceed their bound; results after a false step are meaningless.
class Payload {
  public:
    Payload(const std::uint8_t* data, std::size_t size);

    /// One number of `size` bytes: 1, 2, 4 or 8.
    [[nodiscard]] bool number(std::size_t size);
    /// An enumerator below `count`.
    [[nodiscard]] bool choice(std::size_t count);
    /// A string of at most `bound` characters.
    [[nodiscard]] bool text(std::size_t bound);
    /// A sequence of at most `bound` numbers.
    [[nodiscard]] bool numbers(std::size_t bound, std::size_t size);
    /// A sequence of at most `bound` elements, each stepped over by `element`.
    template <class Element>
    [[nodiscard]] bool each(std::size_t bound, const Element& element) {
        std::uint32_t count = 0;
        // An element has at least one byte.
        if (!word(count) || count > bound || count > bytes_.size() - at_) {
            return false;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            if (!element()) {
                return false;
            }
        }
        return true;
    }

  private:
    [[nodiscard]] bool skip(std::size_t bytes, std::size_t alignment);
    [[nodiscard]] bool word(std::uint32_t& value);

    std::span<const std::uint8_t> bytes_;  // without the encapsulation, from which alignment counts
    std::size_t at_ = 0;
    bool little_endian_ = true;
    bool known_ = false;  // the encapsulation
};

}  // namespace eti::bus
