// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <string_view>

namespace eti::view {

/// Without control characters, which would upset a terminal or a line on the screen.
[[nodiscard]] inline bool printable(std::string_view text) {
    return std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

}  // namespace eti::view
