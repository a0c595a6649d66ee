// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "common/bus/topics.hpp"

namespace eti::devices {

/// A session's description, whatever its server's version: scenario, tools, names, and each runtime parameter
/// with range and current value in typed units. `now` [SI]: in the order of the description; may be empty.
[[nodiscard]] nlohmann::ordered_json session_list(const bus::msg::SessionDescription& session,
                                                  std::span<const float> now);

/// The same as text, with one line per runtime parameter.
[[nodiscard]] std::string session_text(const nlohmann::ordered_json& list);

}  // namespace eti::devices
