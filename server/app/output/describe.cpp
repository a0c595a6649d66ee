// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/output/describe.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <string>
#include <string_view>

#include "common/bus/topics.hpp"
#include "common/model/attempt_metrics.hpp"
#include "common/model/landmark.hpp"
#include "common/model/newborn_shape.hpp"
#include "common/model/runtime_parameters.hpp"
#include "common/model/thresholds.hpp"
#include "common/model/tissue.hpp"
#include "common/model/tools/tools.hpp"
#include "common/scenario/scenario.hpp"

namespace eti::app {

namespace {

using nlohmann::ordered_json;

/// As a person types it: without the digits of a float's rounding.
double typed(float value) {
    return std::stod(fmt::format("{:.6g}", value));
}

template <class Values>
ordered_json row(const Field<Values>& field) {
    return {{"key", field.key()},      {"label", field.label},      {"unit", field.unit},
            {"low", typed(field.low)}, {"high", typed(field.high)}, {"default", typed(field.default_value())},
            {"help", field.help}};
}

/// Adds the rows of a table that a scenario sets, by key.
template <class Rows>
void add_settings(const Rows& rows, bool live, ordered_json& to) {
    for (const auto& field : rows) {
        if (!field.section.empty()) {
            ordered_json setting = row(field);
            setting["key"] = std::string(field.section) + "." + field.key_in_section();
            setting["live"] = live;
            if constexpr (requires { field.on_off; }) {
                setting["on_off"] = field.on_off;
            }
            to.push_back(setting);
        }
    }
}

}  // namespace

ordered_json description() {
    ordered_json out{{"version", ETI_VERSION}, {"protocol", bus::protocol}};
    out["scenario"] = ordered_json::array();
    add_settings(shape_fields, false, out["scenario"]);
    add_settings(runtime_parameter_fields, true, out["scenario"]);
    add_settings(tube_fields, false, out["scenario"]);
    for (const KeyDescription& key : describe_scenario()) {
        out["scenario_other"].push_back(
            {{"key", key.key}, {"values", key.values}, {"default", key.otherwise}, {"help", key.help}});
    }
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        ordered_json live = row(field);
        live["name"] = field.name;
        live["rate"] = typed(field.relative ? field.rate : field.rate / field.per_unit);
        live["relative"] = field.relative;
        live["on_off"] = field.on_off;
        out["live"].push_back(live);
    }
    for (const MetricField& field : metric_fields) {
        out["parameters"].push_back({{"key", field.key},
                                     {"label", field.label},
                                     {"unit", field.unit},
                                     {"in_paper", field.in_paper},
                                     {"run", describe(field.combine)},
                                     {"definition", field.definition},
                                     {"norm", field.norm}});
    }
    for (const Threshold& threshold : thresholds) {
        out["thresholds"].push_back({{"name", threshold.name},
                                     {"value", threshold.value},
                                     {"unit", threshold.unit},
                                     {"meaning", threshold.meaning}});
    }
    out["landmarks"] = landmark_names;
    out["tissues"] = tissue_names;
    return out;
}

}  // namespace eti::app
