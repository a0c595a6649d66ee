// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace eti {

/// Maximum length [bytes] of quoted text in a message.
inline constexpr std::size_t max_shown_bytes = 60;

/// `text` made safe for a terminal. Control characters of ASCII and of Latin-1 (U+0080 to U+009F) and bytes
/// that are not UTF-8 are written as \x1b, \t and \n by their letters. Text longer than `most` bytes is cut
/// at a character boundary and ends in "...".
[[nodiscard]] std::string escaped(std::string_view text, std::size_t most = std::string_view::npos);

/// The same for a whole message: keeps line ends and tabs.
[[nodiscard]] std::string escaped_lines(std::string_view text);

}  // namespace eti
