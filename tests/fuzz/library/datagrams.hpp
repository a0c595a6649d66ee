// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace eti::fuzz {

/// One datagram of an input.
struct Datagram {
    bool to_user_port = false;  ///< else to the port of discovery
    std::vector<std::uint8_t> bytes;
};
using Datagrams = std::vector<Datagram>;

using Prefix = std::array<std::uint8_t, 12>;
/// Stands for the GUID prefix of the participant that receives. Other prefixes may begin with its first half,
/// as those of one process do.
inline constexpr Prefix own_prefix = {'o', 'w', 'n', ' ', 'h', 'o', 's', 't', ' ', 'i', 'd', '!'};
inline constexpr std::size_t head_bytes = 8;
/// That of the other program in recorded inputs.
inline constexpr Prefix peer = {0x01, 0x0f, 'p', 'e', 'e', 'r', ' ', ' ', 0, 0, 0, 0};

/// An input is a sequence of: size (two bytes, little-endian), port (one byte), content. A size of zero ends
/// it; content may be cut off by the end.
inline Datagrams parse(std::span<const std::uint8_t> input) {
    Datagrams out;
    while (input.size() > 3) {
        const std::size_t size = input[0] | static_cast<std::size_t>(input[1]) << 8;
        if (size == 0) {
            break;
        }
        const auto content = input.subspan(3, std::min(size, input.size() - 3));
        out.push_back({(input[2] & 1) != 0, {content.begin(), content.end()}});
        input = input.subspan(3 + content.size());
    }
    return out;
}

inline void append(std::vector<std::uint8_t>& input, const Datagram& one) {
    const std::size_t size = std::min<std::size_t>(one.bytes.size(), 0xffff);
    input.push_back(static_cast<std::uint8_t>(size));
    input.push_back(static_cast<std::uint8_t>(size >> 8));
    input.push_back(one.to_user_port ? 1 : 0);
    input.insert(input.end(), one.bytes.begin(), one.bytes.begin() + static_cast<std::ptrdiff_t>(size));
}

inline std::vector<std::uint8_t> input_of(const Datagrams& datagrams) {
    std::vector<std::uint8_t> out;
    for (const Datagram& one : datagrams) {
        if (!one.bytes.empty()) {
            append(out, one);
        }
    }
    return out;
}

/// Replaces every occurrence by as many bytes.
inline void replace(std::vector<std::uint8_t>& bytes, std::span<const std::uint8_t> what,
                    std::span<const std::uint8_t> by) {
    for (auto at = bytes.begin();;) {
        const auto [first, last] = std::ranges::search(std::ranges::subrange(at, bytes.end()), what);
        if (first == bytes.end()) {
            return;
        }
        std::ranges::copy(by, first);
        at = last;
    }
}

/// Replaces a prefix, and its first half in prefixes of the same process.
inline void replace_prefix(std::vector<std::uint8_t>& bytes, const Prefix& what, const Prefix& by) {
    replace(bytes, what, by);
    replace(bytes, std::span(what).first(head_bytes), std::span(by).first(head_bytes));
}

}  // namespace eti::fuzz
