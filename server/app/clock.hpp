// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

#include "common/model/pace.hpp"

namespace eti::app {

/// Paces steps by the wall clock and keeps account of their cost. A step that comes late moves the
/// whole schedule: simulation time falls behind the clock and never jumps or hurries to catch up.
///
/// `left_to_others`: share of the steps' cost to sleep at least, on the average over some tenths of a second.
/// A simulation of real-time priority that hardly sleeps would have the kernel take the processor from it,
/// and from the haptic loop, for 50 ms at a time.
class StepClock {
  public:
    using Time = std::chrono::steady_clock;

    StepClock(double step_seconds, bool paced, double left_to_others = 0.0)
        : period_(std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(step_seconds))),
          paced_(paced),
          left_to_others_(left_to_others),
          next_(Time::now()) {}

    /// Waits for the next step's time.
    void wait() {
        if (paced_) {
            const auto now = Time::now();
            rested_ -= last_cost_ * left_to_others_;
            const auto start = std::max(next_, now + std::chrono::duration_cast<Time::duration>(-rested_));
            if (start > now) {
                std::this_thread::sleep_until(start);
                rested_ = std::min<Seconds>(rested_ + (start - now), most_rested);
            }
            if (const auto begin = std::max(start, now); begin > next_) {
                behind_ += begin - next_;
                ++late_;
                next_ = begin;
            }
            next_ += period_;
        }
        started_ = Time::now();
    }

    /// Call when the step's work is done.
    void done() {
        last_cost_ = Time::now() - started_;
        const double cost = last_cost_.count();
        costs_[count_++ % costs_.size()] = static_cast<float>(cost);
        most_ = std::max(most_, cost);
        load_ += (cost / std::chrono::duration<double>(period_).count() - load_) / steps_per_second;
    }

    /// Waits for as long as a step takes, while none is taken: time stands still and does not fall behind.
    void stand_still() {
        std::this_thread::sleep_for(period_);
        next_ = Time::now();
    }

    /// [s], that simulation time has fallen behind the clock.
    [[nodiscard]] double behind() const { return std::chrono::duration<double>(behind_).count(); }
    [[nodiscard]] std::uint32_t late() const { return late_; }
    /// Step time over step budget, mean of about the last second.
    [[nodiscard]] double load() const { return load_; }
    /// Share `p` of the last steps, of `most` at most, took no longer than this [s].
    [[nodiscard]] double percentile(double p, std::size_t most = SIZE_MAX) const {
        std::vector<float> sorted;
        for (std::size_t back = 1; back <= std::min({most, count_, costs_.size()}); ++back) {
            sorted.push_back(costs_[(count_ - back) % costs_.size()]);
        }
        if (sorted.empty()) {
            return 0.0;
        }
        const auto rank = static_cast<std::size_t>(p * static_cast<double>(sorted.size() - 1));
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(rank), sorted.end());
        return sorted[rank];
    }
    [[nodiscard]] double most() const { return most_; }

  private:
    using Seconds = std::chrono::duration<double>;
    /// What it may owe to others; a few long steps are not made longer.
    static constexpr Seconds most_rested{0.02};

    Time::duration period_;
    bool paced_;
    double left_to_others_;
    Seconds last_cost_{}, rested_ = most_rested;
    Time::time_point next_, started_;
    Time::duration behind_{};
    std::uint32_t late_ = 0;
    std::vector<float> costs_ = std::vector<float>(20'000);
    std::size_t count_ = 0;
    double most_ = 0.0, load_ = 0.0;
};

}  // namespace eti::app
