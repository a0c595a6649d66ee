// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace eti {

/// Bytes of a found text that are shown in a message; more helps nobody.
inline constexpr std::size_t longest_shown = 60;

/// `text` as a terminal may show it. Control characters of ASCII and of Latin-1 (U+0080 to U+009F) and bytes
/// that are no UTF-8 are written as \x1b, \t and \n by their letters. What is longer than `most` bytes is cut
/// at a whole character and ends in "...".
[[nodiscard]] std::string escaped(std::string_view text, std::size_t most = std::string_view::npos);

/// The same, but for line ends and tabs, which stay: for a whole message.
[[nodiscard]] std::string escaped_lines(std::string_view text);

}  // namespace eti
