// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>

namespace eti {

/// Step rate of a session, the same for every program. It is fixed: an overloaded server falls behind real
/// time instead of using longer steps.
inline constexpr int steps_per_second = 180;
inline constexpr float step_duration = 1.0f / steps_per_second;  ///< [s], of simulation time

/// Simulation time [ns] at the end of a step.
[[nodiscard]] constexpr std::uint64_t time_ns_of(std::uint64_t step) {
    return step * 1'000'000'000ULL / steps_per_second;
}

}  // namespace eti
