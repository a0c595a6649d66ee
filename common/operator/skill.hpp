// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/operator/operator.hpp"

namespace eti {

/// The scripts of a run's attempts, as a hand of the script's skill plays them: `script.attempts` of them,
/// never none. Each strays from the script by its variation, drawn from `seed`; a skill of 1 plays it as it
/// is written. From the second on the tube is drawn back first. Deterministic in both.
[[nodiscard]] std::vector<OperatorScript> attempts_of(const OperatorScript& script, std::uint64_t seed);

}  // namespace eti
