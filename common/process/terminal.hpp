// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <termios.h>

#include <chrono>
#include <optional>

namespace eti {

/// Standard input as single keys, without echo and without waiting for Enter, while it lives. Ctrl-C alone
/// stays what it is. Does nothing where standard input is no terminal.
class Terminal {
  public:
    Terminal();
    ~Terminal();
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    [[nodiscard]] bool there() const { return there_; }

    /// The next key within `patience`: a letter, or 'U', 'D', 'L', 'R' for the arrows, 27 for Escape and what
    /// else is no letter; 0 when the terminal is gone.
    [[nodiscard]] std::optional<char> key(std::chrono::milliseconds patience);

  private:
    bool there_ = false;
    termios before_{};
};

}  // namespace eti
