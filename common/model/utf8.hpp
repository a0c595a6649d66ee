// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace eti {

/// Length [bytes] of the longest prefix of a UTF-8 text that has at most `most` bytes and splits no
/// character.
[[nodiscard]] inline std::size_t utf8_prefix_length(std::string_view text, std::size_t most) {
    std::size_t size = std::min(text.size(), most);
    // Bytes 10xxxxxx continue a character.
    while (size > 0 && size < text.size() && (static_cast<unsigned char>(text[size]) & 0xc0u) == 0x80u) {
        --size;
    }
    return size;
}

/// Whether the text has no control characters, which would disturb a terminal or an on-screen line.
[[nodiscard]] inline bool printable(std::string_view text) {
    return std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

}  // namespace eti
