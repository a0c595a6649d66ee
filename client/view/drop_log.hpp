// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

namespace eti::view {

/// Counts rejected messages and logs at most one per second, so that a sender of invalid data cannot flood
/// the log.
class DropLog {
  public:
    void note(std::string_view topic, std::string_view why);
    [[nodiscard]] std::uint64_t count() const { return count_; }

  private:
    std::uint64_t count_ = 0;
    std::chrono::steady_clock::time_point last_line_{};
};

}  // namespace eti::view
