// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/options.hpp"

namespace eti::app {

/// Simulates the inputs of a recorded session again and compares every step with the record; with overrides,
/// reports the results of the same hands on another patient. Returns the program's exit status: 0 if all
/// steps are equal, or with overrides.
[[nodiscard]] int resimulate(const Options& options);

}  // namespace eti::app
