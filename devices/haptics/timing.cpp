// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/timing.hpp"

#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <numeric>

namespace eti::devices {

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

}  // namespace

std::int64_t monotonic_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::int64_t>(now.tv_sec) * second_ns + now.tv_nsec;
}

void sleep_until_ns(std::int64_t when) {
    const timespec until{static_cast<time_t>(when / second_ns), static_cast<long>(when % second_ns)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

void CycleStatistics::record(std::int64_t interval_ns) {
    const auto last = static_cast<std::int64_t>(bins_.size()) - 1;
    ++bins_[static_cast<std::size_t>(std::clamp(interval_ns / bin_ns_, std::int64_t{0}, last))];
    ++count_;
    longest_ = std::max(longest_, interval_ns);
}

double CycleStatistics::percentile(double p) const {
    if (count_ == 0) {
        return 0.0;
    }
    const auto wanted = static_cast<std::uint64_t>(std::ceil(p * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin + 1 < bins_.size(); ++bin) {
        seen += bins_[bin];
        if (seen >= wanted) {
            return std::min(static_cast<double>(bin + 1) * 1e-9 * static_cast<double>(bin_ns_), longest());
        }
    }
    return longest();
}

double CycleStatistics::share_over(double limit) const {
    if (count_ == 0) {
        return 0.0;
    }
    const auto from = static_cast<std::ptrdiff_t>(
        std::min(limit * 1e9 / static_cast<double>(bin_ns_), static_cast<double>(bins_.size() - 1)));
    const auto over = std::accumulate(bins_.begin() + from, bins_.end(), std::uint64_t{0});
    return static_cast<double>(over) / static_cast<double>(count_);
}

}  // namespace eti::devices
