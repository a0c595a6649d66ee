// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/scenario/setting.hpp"

namespace eti {

/// Values of what lives that go together: how hard an intubation is.
struct Preset {
    std::string name;                 ///< what to ask for it by
    std::string description;          ///< a sentence for whoever chooses
    std::vector<LiveSetting> values;  ///< in the order of live_fields; never empty
};

/// Reads and checks a preset: `name`, `description`, and under `set` keys as eti-controller --set has them.
/// Throws InputError.
[[nodiscard]] Preset load_preset(const std::filesystem::path& file);

/// The same from text; `file` is only named in errors, and gives the name where the text has none.
[[nodiscard]] Preset parse_preset(const std::string& text, const std::filesystem::path& file);

/// Every preset of the data folders, by name, and what is wrong with those that cannot be read.
struct Presets {
    std::vector<Preset> all;
    std::vector<std::string> errors;
};
[[nodiscard]] Presets load_presets();

}  // namespace eti
