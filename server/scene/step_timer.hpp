// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

namespace eti::scene {

/// Stages of a step, in order.
enum class StepStage { rigid, reach, predict, tissue, blade, tube, shell, finish, snapshot, count };

[[nodiscard]] constexpr std::string_view name_of(StepStage stage) {
    constexpr std::array<std::string_view, static_cast<std::size_t>(StepStage::count)> names = {
        "posture and rigid layer",
        "what tools can reach",
        "predict",
        "clusters and links",
        "blade",
        "tube",
        "shell",
        "finish",
        "skinning and snapshot"};
    return names[static_cast<std::size_t>(stage)];
}

/// Wall time of a step by stage. The simulation does not depend on it. Used by the physics thread only.
class StepTimer {
  public:
    using Clock = std::chrono::steady_clock;
    void start() {
        spent_ = {};
        last_ = Clock::now();
    }
    /// Adds the time since the last call to `stage`.
    void lap(StepStage stage) {
        const Clock::time_point now = Clock::now();
        spent_[static_cast<std::size_t>(stage)] += now - last_;
        last_ = now;
    }
    [[nodiscard]] double ms(StepStage stage) const {
        return std::chrono::duration<double, std::milli>(spent_[static_cast<std::size_t>(stage)]).count();
    }

  private:
    Clock::time_point last_;
    std::array<Clock::duration, static_cast<std::size_t>(StepStage::count)> spent_{};
};

}  // namespace eti::scene
