// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <string_view>

namespace eti::view {

/// Whether the text has no control characters, which would disturb a terminal or an on-screen line.
[[nodiscard]] inline bool printable(std::string_view text) {
    return std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

}  // namespace eti::view
