// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::client {

/// Code points for keys that type no character.
inline constexpr char32_t key_left = U'\u2190', key_up = U'\u2191', key_right = U'\u2192',
                          key_down = U'\u2193', key_enter = U'\r', key_backspace = U'\b',
                          key_escape = U'\u001b';
/// Likewise; from the private use area.
inline constexpr char32_t key_f1 = U'\uF704';

}  // namespace eti::client
