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

/// Paces steps by the wall clock and measures their cost. A late step shifts the whole schedule: simulation
/// time falls behind and never jumps or speeds up to catch up.
///
/// `min_idle_share`: minimum sleep as a fraction of the steps' cost, averaged over some tenths of a second.
/// The kernel throttles a real-time process that hardly sleeps, and with it the haptic loop, for 50 ms at a
/// time.
class StepClock {
  public:
    using Time = std::chrono::steady_clock;

    StepClock(double step_seconds, bool paced, double min_idle_share = 0.0)
        : period_(std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(step_seconds))),
          paced_(paced),
          min_idle_share_(min_idle_share),
          next_(Time::now()) {}

    /// Waits until the next step is due.
    void wait() {
        if (paced_) {
            const auto now = Time::now();
            idle_credit_ -= last_cost_ * min_idle_share_;
            const auto start =
                std::max(next_, now + std::chrono::duration_cast<Time::duration>(-idle_credit_));
            if (start > now) {
                std::this_thread::sleep_until(start);
                idle_credit_ = std::min<Seconds>(idle_credit_ + (start - now), max_idle_credit);
            }
            if (const auto begin = std::max(start, now); begin > next_) {
                behind_ += begin - next_;
                ++late_steps_;
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
        max_cost_ = std::max(max_cost_, cost);
        load_ += (cost / std::chrono::duration<double>(period_).count() - load_) / steps_per_second;
    }

    /// Waits for one step period while the simulation is paused; simulation time does not fall behind.
    void pause() {
        std::this_thread::sleep_for(period_);
        next_ = Time::now();
    }

    /// Lag of simulation time behind the wall clock [s].
    [[nodiscard]] double behind() const { return std::chrono::duration<double>(behind_).count(); }
    [[nodiscard]] std::uint32_t late_steps() const { return late_steps_; }
    /// Step cost over step period, averaged over about the last second.
    [[nodiscard]] double load() const { return load_; }
    /// Cost [s] that a fraction `p` of the last steps, at most `most`, did not exceed.
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
    [[nodiscard]] double max_cost() const { return max_cost_; }

  private:
    using Seconds = std::chrono::duration<double>;
    /// Upper bound of the idle credit; a few long steps do not cause sleep.
    static constexpr Seconds max_idle_credit{0.02};

    Time::duration period_;
    bool paced_;
    double min_idle_share_;
    Seconds last_cost_{}, idle_credit_ = max_idle_credit;
    Time::time_point next_, started_;
    Time::duration behind_{};
    std::uint32_t late_steps_ = 0;
    std::vector<float> costs_ = std::vector<float>(20'000);
    std::size_t count_ = 0;
    double max_cost_ = 0.0, load_ = 0.0;
};

}  // namespace eti::app
