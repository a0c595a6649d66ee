// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "common/model/pace.hpp"
#include "common/process/threads/priority.hpp"
#include "server/parallel/worker_start.hpp"

namespace eti::app {

/// Decides whether a simulation runs at real-time priority. One that cannot keep up would hold a core for as
/// long as it runs, and take it from every ordinary thread of its machine, those of devices and clients
/// included, without ever being in time. It gives way after a run of late steps, and gets its priority back
/// once it has kept time; each time that it then gives way again, it must have kept time for twice as long.
class PriorityPolicy {
  public:
    using Clock = std::chrono::steady_clock;
    /// Late in a row: a second of simulation time. A shorter burst passes by itself.
    static constexpr int late_steps_to_yield = 180;
    static constexpr std::chrono::seconds shortest_time_kept{5}, longest_time_kept{80};
    /// Share of the steps that may be late in time kept; with more, keeping time begins anew.
    static constexpr double tolerated_share = 0.05;

    enum class Change : std::uint8_t { none, yield, resume };

    /// `late`: the step that has ended began later than due.
    Change update(bool late, Clock::time_point now) {
        if (!yielded_) {
            late_in_a_row_ = late ? late_in_a_row_ + 1 : 0;
            if (late_in_a_row_ < late_steps_to_yield) {
                return Change::none;
            }
            yielded_ = true;
            start_keeping(now);
            return Change::yield;
        }
        late_ += late ? 1 : 0;
        if (late_ > tolerated_share * steps_per_second * static_cast<double>(time_to_keep_.count())) {
            start_keeping(now);
            return Change::none;
        }
        if (now - kept_since_ < time_to_keep_) {
            return Change::none;
        }
        yielded_ = false;
        late_in_a_row_ = 0;
        time_to_keep_ = std::min<std::chrono::seconds>(2 * time_to_keep_, longest_time_kept);
        return Change::resume;
    }

    [[nodiscard]] bool yielded() const { return yielded_; }

  private:
    void start_keeping(Clock::time_point now) {
        kept_since_ = now;
        late_ = 0;
    }

    bool yielded_ = false;
    int late_in_a_row_ = 0;
    int late_ = 0;  // steps since kept_since_
    Clock::time_point kept_since_{};
    std::chrono::seconds time_to_keep_ = shortest_time_kept;
};

/// The simulation's threads, the constructing one and the solver's workers, at real-time priority during its
/// lifetime, except while PriorityPolicy has them give way. Not for runs faster than real time: they would
/// starve other processes.
class StepPriority {
  public:
    /// `wanted`: false does nothing.
    explicit StepPriority(bool wanted);
    ~StepPriority();
    StepPriority(const StepPriority&) = delete;
    StepPriority& operator=(const StepPriority&) = delete;

    /// Call after each step. Logs the first change of each kind.
    void update(bool late);

  private:
    void add_worker();
    void set_all(int priority);

    bool wanted_, granted_ = false;
    bool told_ = false, told_back_ = false;
    PriorityPolicy policy_;
    std::mutex mutex_;
    std::vector<ThreadId> threads_;
    int priority_ = priority::step;
    std::optional<parallel::WorkerStart> workers_;
};

}  // namespace eti::app
