// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <mutex>
#include <string_view>

namespace eti {

/// A progress bar on standard error if that is a terminal, drawn at most ten times a second. Thread-safe.
class ProgressBar {
  public:
    ProgressBar();

    /// `share`: progress, 0 to 1; `what`: text after the bar.
    void draw(float share, std::string_view what);
    void clear() const;

  private:
    bool on_terminal_;
    std::chrono::steady_clock::time_point drawn_{};
    std::mutex mutex_;
};

}  // namespace eti
