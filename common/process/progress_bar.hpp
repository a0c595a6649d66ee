// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <mutex>
#include <string_view>

namespace eti {

/// A bar on standard error where that is a terminal, at most ten times a second. Several threads may draw it.
class ProgressBar {
  public:
    ProgressBar();

    /// `share`: of what is to do, 0 to 1; `what` stands behind it.
    void draw(float share, std::string_view what);
    void clear() const;

  private:
    bool on_terminal_;
    std::chrono::steady_clock::time_point drawn_{};
    std::mutex mutex_;
};

}  // namespace eti
