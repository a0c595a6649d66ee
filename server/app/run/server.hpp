// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/options.hpp"

namespace eti::app {

/// Runs one session to its end. Returns the program's exit code: 0 if the session ran and ended normally,
/// whatever the outcome of the intubation; 1 if an input was rejected; 3 if the session file is incomplete.
[[nodiscard]] int run_server(const Options& options);

}  // namespace eti::app
