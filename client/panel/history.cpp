// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/text/catalogue.hpp"

namespace eti::panel {
namespace {

constexpr LiveMeasureField server_load{
    .short_label = text::translatable("server's load"), .unit = "%", .plot_high = 100.0f, .bad = 100.0f};

}  // namespace

float Series::high() const {
    float out = field->plot_high;
    for (const Sample& sample : samples) {
        out = std::max(out, sample.value);
    }
    return out;
}

float Series::low() const {
    float out = 0.0f;
    for (const Sample& sample : samples) {
        out = std::min(out, sample.value);
    }
    return out;
}

History::History() {
    for (const LiveMeasureField& field : live_measure_fields) {
        if (field.plot_high > 0.0f) {
            series_.push_back({&field});
        }
    }
    series_.push_back({&server_load});
}

void History::follow(const view::SceneView& scene) {
    if (!scene.metrics()) {
        return;
    }
    const double time_s = 1e-9 * static_cast<double>(scene.metrics()->header().simulation_time_ns());
    if (time_s < newest_s_) {
        *this = History();
    }
    if (time_s == newest_s_) {
        return;
    }
    newest_s_ = time_s;
    // On a manikin they are not measured; 0 would look like a measurement.
    const bool measured =
        !scene.keys() || airway_measured(scene.keys()->metrics(scene.metrics()->parameters()));
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    for (auto& [field, samples] : series_) {
        const float value = field == &server_load ? (scene.status() ? 100.0f * scene.status()->load() : none)
                            : measured            ? scene.measures().*field->value / field->per_unit
                                                  : none;
        if (std::isfinite(value)) {
            samples.push_back({time_s, std::max(field->plot_low, value)});
        }
        while (!samples.empty() && samples.front().time_s < time_s - span_s) {
            samples.pop_front();
        }
    }
}

}  // namespace eti::panel
