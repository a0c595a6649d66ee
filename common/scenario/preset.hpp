// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scenario/setting.hpp"

namespace eti {

/// A named set of runtime parameters: how hard an intubation is.
struct Preset {
    std::string name;                             ///< name used to select it
    std::string description;                      ///< one sentence for the user
    std::vector<RuntimeParameterSetting> values;  ///< in the order of runtime_parameter_fields; never empty
};

/// Reads and validates a preset: `name`, `description`, and under `set` the keys of eti-controller --set.
/// Throws InputError.
[[nodiscard]] Preset load_preset(const std::filesystem::path& file);

/// The same from text. `file` is only used in errors, and gives the name where the text has none.
[[nodiscard]] Preset parse_preset(const std::string& text, const std::filesystem::path& file);

/// All presets of the data folders by name, and the errors of those that cannot be read.
struct Presets {
    std::vector<Preset> all;
    std::vector<std::string> errors;
};
[[nodiscard]] Presets load_presets();

}  // namespace eti
