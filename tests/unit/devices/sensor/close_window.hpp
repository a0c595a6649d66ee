// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

namespace eti::test {

/// Asks the window whose title begins so to close, as the button in its corner does. False: there is none.
/// In a file of its own: Xlib's macros do not go with other libraries.
[[nodiscard]] bool close_window(const std::string& title);

}  // namespace eti::test
