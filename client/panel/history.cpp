// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/hud/readout.hpp"
#include "common/math/units.hpp"

namespace eti::panel {
namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

}  // namespace

float Series::high() const {
    float out = min_high;
    for (const Sample& sample : samples) {
        out = std::max(out, sample.value);
    }
    return out;
}

float Series::low() const {
    float out = 0.0f;
    for (const Sample& sample : samples) {
        out = std::min(out, negative ? sample.value : 0.0f);
    }
    return out;
}

History::History()
    : series_{Series{"gum force", "N", 6.0f, false, hud::gum_force_warning_n, hud::gum_force_bad_n},
              Series{"glottis seen", "%", 100.0f, false, none, none},
              Series{"tube past cords", "cm", 4.0f, true, none, none},
              Series{"server's load", "%", 100.0f, false, none, 100.0f}} {}

void History::follow(const view::SceneView& scene) {
    if (!scene.metrics()) {
        return;
    }
    const msg::LiveMetrics& metrics = *scene.metrics();
    const double time_s = 1e-9 * static_cast<double>(metrics.header().simulation_time_ns());
    if (time_s < newest_s_) {
        *this = History();
    }
    if (time_s == newest_s_) {
        return;
    }
    newest_s_ = time_s;
    // Depths below the mouth are not meaningful: a tube outside may be anywhere.
    constexpr float least_depth_cm = -5.0f;
    // On a manikin they are not measured; 0 would look like a measurement.
    const bool measured = !scene.keys() || airway_measured(scene.keys()->metrics(metrics.parameters()));
    const std::array values{
        measured ? metrics.gum_force_n() : none, measured ? metrics.glottic_opening_percent() : none,
        measured ? std::max(least_depth_cm, metrics.tube_depth_past_glottis() / centimetre) : none,
        scene.status() ? 100.0f * scene.status()->load() : none};
    for (std::size_t i = 0; i < series_.size(); ++i) {
        auto& samples = series_[i].samples;
        if (std::isfinite(values[i])) {
            samples.push_back({time_s, values[i]});
        }
        while (!samples.empty() && samples.front().time_s < time_s - span_s) {
            samples.pop_front();
        }
    }
}

}  // namespace eti::panel
