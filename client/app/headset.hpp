// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>

#include "client/app/options.hpp"

namespace eti::client {

/// Shows a session in a headset until whoever wears it leaves, --frames are drawn or the program is asked to
/// stop. A headset that is not there yet, or gone, is waited for. Fills `result` for --json. Returns the exit
/// status; throws std::runtime_error on what a person can mend, such as a runtime that is not installed.
[[nodiscard]] int run_headset(const Options& options, nlohmann::json& result);

}  // namespace eti::client
