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

/// Lets one line a second through for each cause, so that nobody floods a log. For any thread.
class LineLimit {
  public:
    using Clock = std::chrono::steady_clock;

    /// How many lines of this cause were kept back since the last one, when one may be written now.
    [[nodiscard]] std::optional<std::uint64_t> allow(std::string_view cause,
                                                     Clock::time_point now = Clock::now());

    /// Causes told apart; those beyond share one.
    static constexpr std::size_t most_causes = 64;

  private:
    struct Line {
        Clock::time_point last;
        std::uint64_t kept_back = 0;
    };
    std::mutex mutex_;
    std::map<std::string, Line, std::less<>> lines_;
};

/// " (N more like it)", or nothing.
[[nodiscard]] std::string and_more(std::uint64_t kept_back);

}  // namespace eti
