// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/app/options.hpp"

namespace eti::app {

/// Runs one session to its end. Returns the program's exit code: 0 when the session ran and ended in
/// order, whatever became of the intubation; 1 for an input that was refused; 3 when the session file
/// could not be kept whole.
[[nodiscard]] int run_server(const Options& options);

}  // namespace eti::app
