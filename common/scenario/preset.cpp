// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/preset.hpp"

#include <spdlog/fmt/fmt.h>

#include "common/scenario/yaml_map.hpp"

namespace eti {

Preset load_preset(const std::filesystem::path& file) {
    return parse_preset(read_text_file(file), file);
}

Preset parse_preset(const std::string& text, const std::filesystem::path& file) {
    YamlMap root = YamlMap::parse(text, file.string());
    Preset preset;
    preset.name = root.name("name", file.stem().string());
    preset.description = root.text("description", "");
    if (preset.description.empty()) {
        root.refuse("description", "nothing", "a sentence that describes the preset");
    }
    if (auto set = root.map("set")) {
        for (const RuntimeParameterField& field : runtime_parameter_fields) {
            const std::string key = field.key();
            // Both variants read the key, so that finish() accepts it.
            const float value = field.on_off
                                    ? (set->flag(key, false) ? 1.0f : 0.0f)
                                    : set->number(key, 0.0f, {field.low, field.high, field.per_unit});
            if (set->has(key)) {
                preset.values.push_back({&field, value});
            }
        }
        set->finish();
    }
    root.finish();
    if (preset.values.empty()) {
        root.refuse("set", "no values", "at least one, as in 'tongue_scale: 1.2'");
    }
    return preset;
}

Presets load_presets() {
    Presets out;
    for (const std::string& name : data_names("presets")) {
        try {
            out.all.push_back(load_preset(find_data_file(name, "presets")));
        } catch (const InputError& error) {
            out.errors.emplace_back(error.what());
        }
    }
    return out;
}

}  // namespace eti
