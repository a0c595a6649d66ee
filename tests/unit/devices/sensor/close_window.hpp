// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>

namespace eti::test {

/// Asks the window whose title begins with this to close, as its close button does. Returns false when there
/// is none. In a file of its own, because Xlib's macros clash with other libraries.
[[nodiscard]] bool close_window(const std::string& title);

}  // namespace eti::test
