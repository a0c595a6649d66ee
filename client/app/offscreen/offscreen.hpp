// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>

#include "client/app/options.hpp"

namespace eti::client {

/// Follows a session without a display until it ends, the server is lost, --frames are drawn or the program
/// is asked to stop; writes pictures and video. Fills `result` for --json. Returns the exit status; throws
/// std::runtime_error (including BusError) on errors a user can correct.
[[nodiscard]] int run_offscreen(const Options& options, nlohmann::json& result);

}  // namespace eti::client
