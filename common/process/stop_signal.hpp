// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti {

/// What a program does beside remembering that Ctrl-C or SIGTERM asked it to end.
struct StopSignals {
    /// A second one ends the program at once: for those that may hang where they cannot look.
    bool second_ends = false;
    /// Also SIGHUP and SIGQUIT ask, SIGPIPE is ignored, and system calls that wait return: a terminal that is
    /// closed, or whoever reads the output and goes away, must not end a program with a device in its hand.
    bool holds_device = false;
};

/// Has Ctrl-C and SIGTERM ask the program to end.
void catch_stop_signals(const StopSignals& how = {});

/// Whether one of them came. Child processes inherit what catches them.
[[nodiscard]] bool stop_asked();

/// As if Ctrl-C had been pressed, and its opposite.
void ask_to_stop(bool stop = true);

}  // namespace eti
