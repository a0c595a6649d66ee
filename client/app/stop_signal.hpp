// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::client {

/// Has Ctrl-C and SIGTERM ask the program to end; a second one ends it at once.
void catch_stop_signals();

[[nodiscard]] bool stop_asked();

/// As if Ctrl-C had been pressed, and its opposite.
void ask_to_stop(bool stop = true);

}  // namespace eti::client
