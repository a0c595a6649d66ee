// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>
#include <string_view>

#include "client/hands/drag.hpp"
#include "client/render/views/view_table.hpp"

namespace eti::client {

/// One row of the table of keys that move the vantage.
struct VantageKey {
    char32_t key;
    std::string_view caption;  ///< key name, in ASCII
    std::string_view help;
    void (*press)(render::Vantage& vantage, const Landmarks& now);
};

[[nodiscard]] std::span<const VantageKey> vantage_keys();
inline constexpr char32_t loupe_key = U'8';  ///< a row of the table

/// The row of a key, or nullptr.
[[nodiscard]] const VantageKey* vantage_key(char32_t key);

/// Applies a mouse drag in a picture of `view`: moves the observer in an outside view, the plane in a
/// section view, otherwise the trainee's eye. The right button turns the eye's gaze or shifts the plane.
void drag(render::Vantage& vantage, const render::View& view, const hands::Drag& mouse, const Landmarks& now);

/// Help text for the mouse.
[[nodiscard]] std::string_view mouse_help();

}  // namespace eti::client
