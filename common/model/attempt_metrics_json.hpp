// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "common/model/attempt_metrics.hpp"

namespace eti {

/// The metrics as a JSON object; "name.max" becomes {"name": {"max": ...}}, NaN becomes null.
[[nodiscard]] inline nlohmann::ordered_json metrics_to_json(const AttemptMetrics& metrics) {
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    for (const MetricField& field : metric_fields) {
        const double value = metrics.*field.value;
        const nlohmann::ordered_json json =
            std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
        const std::size_t dot = field.key.find('.');
        if (dot == std::string_view::npos) {
            out[std::string(field.key)] = json;
        } else {
            out[std::string(field.key.substr(0, dot))][std::string(field.key.substr(dot + 1))] = json;
        }
    }
    return out;
}

}  // namespace eti
