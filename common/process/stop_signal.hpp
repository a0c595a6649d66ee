// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti {

/// Signal handling beyond recording that Ctrl-C or SIGTERM asked the program to end.
struct StopSignals {
    /// A second signal ends the program at once: for programs that may hang where they cannot poll.
    bool second_ends = false;
    /// Also handle SIGHUP and SIGQUIT, ignore SIGPIPE, and interrupt blocking system calls. A closed terminal
    /// or output pipe must not end a program that drives a haptic device.
    bool holds_device = false;
};

/// Installs the handlers by which Ctrl-C and SIGTERM ask the program to end.
void catch_stop_signals(const StopSignals& how = {});

/// Whether one of them has arrived. Child processes inherit the handlers.
[[nodiscard]] bool stop_requested();

/// Sets or clears the request, as if by Ctrl-C.
void request_stop(bool stop = true);

}  // namespace eti
