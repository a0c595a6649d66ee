// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>

#include "client/app/options.hpp"

namespace eti::client {

/// Shows a session in a window until it is closed, --frames are drawn or the program is asked to stop.
/// Reports a lost server in the picture and waits for it. Fills `result` for --json. Returns the exit
/// status; throws std::runtime_error on errors a user can correct.
[[nodiscard]] int run_windowed(const Options& options, nlohmann::json& result);

}  // namespace eti::client
