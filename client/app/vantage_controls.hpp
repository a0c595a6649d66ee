// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>

#include "client/hands/drag.hpp"
#include "client/render/view_table.hpp"

namespace eti::client {

/// One row of the table of keys that move what one looks from.
struct VantageKey {
    char32_t key;
    std::string_view caption;  ///< of the key, in ASCII
    std::string_view help;
    void (*press)(render::Vantage& vantage, const Landmarks& now);
};

[[nodiscard]] std::span<const VantageKey> vantage_keys();

/// The row of a key, or nullptr.
[[nodiscard]] const VantageKey* vantage_key(char32_t key);

/// What the mouse moves in a picture of `view`: from outside the onlooker, in a section its plane, else the
/// trainee's eye; the right button turns that eye's gaze, and shifts the plane.
void drag(render::Vantage& vantage, const render::View& view, const Drag& mouse, const Landmarks& now);

/// Said in the help: what the mouse does.
[[nodiscard]] std::string_view mouse_help();

}  // namespace eti::client
