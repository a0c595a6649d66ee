// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>

#include "common/model/live.hpp"

namespace eti {

/// One value of what lives, as somebody asks for it.
struct LiveSetting {
    const LiveField* field;
    float value;  ///< SI
};

/// The key of "KEY=VALUE".
[[nodiscard]] std::string_view key_of(std::string_view typed);

/// The row that is typed by this key, "head_elevation_deg", or nullptr.
[[nodiscard]] const LiveField* live_field_by_key(std::string_view key);

/// The keys of what lives with units and ranges, for help texts.
[[nodiscard]] std::string live_keys();

/// "tissue_stiffness_kpa=20", "view_clock=on". The range is left to whoever knows what the patient bears.
/// Throws InputError.
[[nodiscard]] LiveSetting live_setting(const std::string& typed);

/// A scenario's text with one value set or replaced, as in "patient.weight_kg=1.1" or "saliva=on"; comments
/// are lost. Whether the scenario has such a key and bears the value is parse_scenario's to say. Throws
/// InputError where `typed` is no KEY=VALUE or `text` no scenario.
[[nodiscard]] std::string with_setting(const std::string& text, const std::string& typed);

}  // namespace eti
