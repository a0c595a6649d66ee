// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <termios.h>

#include <chrono>
#include <optional>

namespace eti {

/// During its lifetime, standard input delivers single keys, without echo and without waiting for Enter. Only
/// Ctrl-C keeps its meaning. Does nothing where standard input is not a terminal.
class Terminal {
  public:
    Terminal();
    ~Terminal();
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    [[nodiscard]] bool there() const { return there_; }

    /// The next key within `timeout`: a letter; 'U', 'D', 'L', 'R' for the arrows; 27 for Escape and other
    /// non-letters; 0 when the terminal is closed.
    [[nodiscard]] std::optional<char> key(std::chrono::milliseconds timeout);

  private:
    bool there_ = false;
    termios before_{};
};

}  // namespace eti
