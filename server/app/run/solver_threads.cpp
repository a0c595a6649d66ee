// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/solver_threads.hpp"

#include <spdlog/spdlog.h>

namespace eti::app {

SolverThreads::SolverThreads(unsigned wanted) : follows_(wanted == 0) {
    use(follows_ ? ProcessorShare::processors() : wanted);
}

void SolverThreads::update(Clock::time_point now) {
    if (!follows_ || now < next_) {
        return;
    }
    next_ = now + period;
    if (const unsigned share = ProcessorShare::processors(); share != count_) {
        spdlog::info("{} simulations share this machine's processors: the solver has {} of {} threads",
                     ProcessorShare::simulations(), share, count_);
        use(share);
    }
}

void SolverThreads::use(unsigned count) {
    count_ = count;
    limit_.emplace(tbb::global_control::max_allowed_parallelism, count);
}

}  // namespace eti::app
