// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>

#include "client/app/options.hpp"

namespace eti::client {

/// Shows a session in a headset until the wearer leaves, --frames are drawn or the program is asked to
/// stop. Waits for a headset that is missing or was disconnected. Fills `result` for --json. Returns the
/// exit status; throws std::runtime_error on errors a user can correct, such as a runtime that is not
/// installed.
[[nodiscard]] int run_headset(const Options& options, nlohmann::json& result);

}  // namespace eti::client
