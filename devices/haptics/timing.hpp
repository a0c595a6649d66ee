// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cstdint>

namespace eti::devices {

[[nodiscard]] std::int64_t monotonic_ns();

/// Sleeps until `when` [ns, CLOCK_MONOTONIC]; a signal may end it early.
void sleep_until_ns(std::int64_t when);

/// Histogram of the intervals between successive events, such as starts of cycles, in 20,000 bins; recording
/// allocates nothing.
class CycleStatistics {
  public:
    explicit CycleStatistics(std::int64_t bin_ns = 1'000) : bin_ns_(bin_ns) {}

    void record(std::int64_t interval_ns);

    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// [s], interval that a share `p` of the intervals does not exceed, to bin resolution, at most the
    /// maximum. The last bin collects all longer intervals; see the maximum for those.
    [[nodiscard]] double percentile(double p) const;
    [[nodiscard]] double longest() const { return static_cast<double>(longest_) * 1e-9; }
    /// Share of the intervals longer than `limit` [s].
    [[nodiscard]] double share_over(double limit) const;

  private:
    std::int64_t bin_ns_;
    std::array<std::uint32_t, 20'000> bins_{};
    std::uint64_t count_ = 0;
    std::int64_t longest_ = 0;
};

}  // namespace eti::devices
