// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <tbb/global_control.h>

#include <chrono>
#include <optional>

#include "common/process/threads/processor_share.hpp"

namespace eti::app {

/// The number of the solver's threads: as wanted, or this process's share of the processors, which changes as
/// simulations on the same machine start and end. Results do not depend on it.
class SolverThreads {
  public:
    using Clock = std::chrono::steady_clock;

    /// `wanted`: 0 for the share.
    explicit SolverThreads(unsigned wanted);

    /// Follows the share; call between steps. Looks at it once in `period`, and logs a change.
    void update(Clock::time_point now = Clock::now());
    [[nodiscard]] unsigned count() const { return count_; }

    static constexpr std::chrono::seconds period{1};

  private:
    void use(unsigned count);

    ProcessorShare share_;
    const bool follows_;
    unsigned count_ = 0;
    Clock::time_point next_{};
    std::optional<tbb::global_control> limit_;
};

}  // namespace eti::app
