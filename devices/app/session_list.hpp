// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "common/bus/topics.hpp"

namespace eti::devices {

/// What a session says of itself, whatever its server's version: scenario, tools, names, and each value that
/// lives with range and present value, as typed. `now` [SI]: in the order of the description; may be empty.
[[nodiscard]] nlohmann::ordered_json session_list(const bus::msg::SessionDescription& session,
                                                  std::span<const float> now);

/// The same for people, a line for each value that lives.
[[nodiscard]] std::string session_text(const nlohmann::ordered_json& list);

}  // namespace eti::devices
