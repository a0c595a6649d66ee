// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>

#include "tests/validation/haptics/closed_loop.hpp"

namespace eti::bench {

using validation::Channel;

struct LiveCase {
    std::string name;
    std::optional<Channel> channel;  ///< through a relay; none: the bus only
    double seconds = 60.0;
};

struct LoopTiming {
    double period_p50 = 0.0, period_p99 = 0.0, period_p999 = 0.0, period_max = 0.0;  ///< [s]
    double late_share = 0.0;   ///< of cycles later than 1.2 ms
    double compute_p99 = 0.0;  ///< [s]
    bool real_time = false;
};

struct LiveOutcome {
    LoopTiming loop;
    double round_trip_p50 = 0.0,
           round_trip_p99 = 0.0;                  ///< [s], from the pose sent to the proxy that answers it
    double force_mean = 0.0, force_max = 0.0;     ///< [N]
    double message_p99 = 0.0, message_max = 0.0;  ///< [s], between consecutive messages
    double excursion = 0.0;                       ///< [m], peak to peak of the held device, last 2 s
    double min_excursion = 0.0;                   ///< [m], the same of the stillest fifth of a second
    double held_force = 0.0;                      ///< [N], mean over the same time
    double stale_share = 0.0;
    double energy_lowest = 0.0, dissipated = 0.0;  ///< [J]
    double passivity_share = 0.0;
    double server_behind = 0.0;  ///< [s], at the end
};

/// Baseline of the machine: a loop that only wakes every millisecond.
[[nodiscard]] LoopTiming run_empty_loop(double seconds, bool beside_a_server);

/// The real haptic loop with a simulated device held still, without a server.
[[nodiscard]] LoopTiming run_loop_alone(double seconds);

/// The real haptic loop in real time with a simulated device, and the real server in a process of its own
/// over DDS. A scripted hand passes over the tongue, levers on the upper gum, and holds still.
[[nodiscard]] LiveOutcome run_live(const LiveCase& live);

}  // namespace eti::bench
