// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <vector>

#include "common/operator/operator.hpp"

namespace eti {

/// The scripts of a run's attempts, `script.attempts` of them, at least one, as a hand of the script's skill
/// plays them. Each deviates from the script by its variation, drawn from `seed`; a skill of 1 plays it as
/// written. From the second attempt on, the tube is first withdrawn. Deterministic in both arguments.
[[nodiscard]] std::vector<OperatorScript> make_attempts(const OperatorScript& script, std::uint64_t seed);

}  // namespace eti
