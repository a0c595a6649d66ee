// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/setting.hpp"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/scenario/yaml_map.hpp"

namespace eti {

std::string_view key_of(std::string_view typed) {
    return typed.substr(0, typed.find('='));
}

const RuntimeParameterField* find_runtime_parameter_by_key(std::string_view key) {
    const auto found = std::ranges::find(runtime_parameter_fields, key, &RuntimeParameterField::key);
    return found == runtime_parameter_fields.end() ? nullptr : &*found;
}

std::string runtime_parameter_help() {
    std::string text;
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        text +=
            fmt::format("{}{} ({:g} to {:g})", text.empty() ? "" : ", ", field.key(), field.low, field.high);
    }
    return text;
}

RuntimeParameterSetting parse_runtime_parameter(const std::string& typed) {
    const std::size_t equals = typed.find('=');
    const RuntimeParameterField* const field = find_runtime_parameter_by_key(key_of(typed));
    if (equals == std::string::npos || field == nullptr) {
        throw InputError(
            fmt::format("--set {}: expected KEY=VALUE with a key of {}", typed, runtime_parameter_help()));
    }
    const std::string wanted = typed.substr(equals + 1);
    if (field->on_off && (wanted == "on" || wanted == "off")) {
        return {field, wanted == "on" ? 1.0f : 0.0f};
    }
    float value = 0.0f;
    const char* const end = wanted.data() + wanted.size();
    const auto [stop, error] = std::from_chars(wanted.data(), end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value)) {
        throw InputError(fmt::format("--set {}: expected {} after '=', {:g} to {:g}", typed,
                                     field->on_off ? "on, off or a plain number" : "a plain number",
                                     field->low, field->high));
    }
    return {field, value * field->per_unit};
}

std::string with_setting(const std::string& text, const std::string& typed) {
    const std::size_t equals = typed.find('=');
    const std::string key(key_of(typed));
    const std::size_t dot = key.find('.');
    const std::string section = dot == std::string::npos ? "" : key.substr(0, dot);
    const std::string name = dot == std::string::npos ? key : key.substr(dot + 1);
    if (equals == std::string::npos || name.empty() || (dot != std::string::npos && section.empty())) {
        throw InputError(fmt::format("--set {}: expected KEY=VALUE, as in patient.weight_kg=1.1", typed));
    }
    (void)YamlMap::parse(text, "scenario");  // rejects constructs that expand a small text
    YAML::Node root = YAML::Load(text);
    YAML::Node map = root;
    if (!section.empty()) {
        if (const YAML::Node there = root[section]; there.IsDefined() && !there.IsNull() && !there.IsMap()) {
            throw InputError(
                fmt::format("--set {}: '{}' is not a section of the scenario; see eti-server --describe",
                            typed, section));
        }
        map.reset(root[section]);
    }
    map[name] = typed.substr(equals + 1);
    YAML::Emitter out;
    out << root;
    return std::string(out.c_str()) + "\n";
}

}  // namespace eti
