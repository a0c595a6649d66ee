// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace eti {

/// Passes one line a second per cause, so that no cause floods the log. Thread-safe.
class LogThrottle {
  public:
    using Clock = std::chrono::steady_clock;

    /// If a line may be written now: the number of lines of this cause suppressed since the last one.
    [[nodiscard]] std::optional<std::uint64_t> allow(std::string_view cause,
                                                     Clock::time_point now = Clock::now());

    /// Number of distinct causes; further ones share an entry.
    static constexpr std::size_t max_causes = 64;

  private:
    struct Line {
        Clock::time_point last;
        std::uint64_t suppressed = 0;
    };
    std::mutex mutex_;
    std::map<std::string, Line, std::less<>> lines_;
};

/// " (N more like it)", or nothing.
[[nodiscard]] std::string suppressed_suffix(std::uint64_t suppressed);

}  // namespace eti
