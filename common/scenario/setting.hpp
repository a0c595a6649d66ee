// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <string_view>

#include "common/model/runtime_parameters.hpp"

namespace eti {

/// A requested value of one runtime parameter.
struct RuntimeParameterSetting {
    const RuntimeParameterField* field;
    float value;  ///< SI
};

/// The key of "KEY=VALUE".
[[nodiscard]] std::string_view key_of(std::string_view typed);

/// The row with this key as typed, such as "head_elevation_deg", or nullptr.
[[nodiscard]] const RuntimeParameterField* find_runtime_parameter_by_key(std::string_view key);

/// The keys of the runtime parameters with units and ranges, for help texts.
[[nodiscard]] std::string runtime_parameter_help();

/// Parses "tissue_stiffness_kpa=20" or "view_clock=on". Does not check the range: the caller knows the
/// patient's limits. Throws InputError.
[[nodiscard]] RuntimeParameterSetting parse_runtime_parameter(const std::string& typed);

/// A scenario's text with one value set or replaced, as in "patient.weight_kg=1.1" or "saliva=on"; comments
/// are lost. The key and its value are not validated here but by parse_scenario. Throws InputError where
/// `typed` is not KEY=VALUE or `text` is not a scenario.
[[nodiscard]] std::string with_setting(const std::string& text, const std::string& typed);

}  // namespace eti
