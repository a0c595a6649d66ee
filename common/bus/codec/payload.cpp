// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/codec/payload.hpp"

namespace eti::bus {

namespace {

constexpr std::size_t encapsulation = 4;  // bytes; the second one gives the byte order

}  // namespace

Payload::Payload(const std::uint8_t* data, std::size_t size) {
    if (size >= encapsulation && data[0] == 0 && data[1] <= 1) {
        known_ = true;
        little_endian_ = data[1] == 1;
        bytes_ = {data + encapsulation, size - encapsulation};
    }
}

bool Payload::skip(std::size_t bytes, std::size_t alignment) {
    const std::size_t from = (at_ + alignment - 1) / alignment * alignment;
    if (!known_ || from > bytes_.size() || bytes > bytes_.size() - from) {
        return false;
    }
    at_ = from + bytes;
    return true;
}

bool Payload::word(std::uint32_t& value) {
    if (!skip(4, 4)) {
        return false;
    }
    value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t shift = 8 * (little_endian_ ? i : 3 - i);
        value |= static_cast<std::uint32_t>(bytes_[at_ - 4 + i]) << shift;
    }
    return true;
}

bool Payload::number(std::size_t size) {
    return skip(size, size);
}

bool Payload::choice(std::size_t count) {
    std::uint32_t value = 0;
    return word(value) && value < count;
}

bool Payload::text(std::size_t bound) {
    // The length includes the terminating zero; some writers omit it for an empty string.
    std::uint32_t length = 0;
    return word(length) && (length == 0 || length - 1 <= bound) && skip(length, 1);
}

bool Payload::numbers(std::size_t bound, std::size_t size) {
    std::uint32_t count = 0;
    return word(count) && count <= bound &&
           (count == 0 || (count <= bytes_.size() && skip(count * size, size)));
}

}  // namespace eti::bus
