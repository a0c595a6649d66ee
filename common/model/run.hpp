// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <span>

#include "common/model/attempt_metrics.hpp"

namespace eti {

/// Metrics of one attempt, with the weights needed to aggregate several.
struct RunPart {
    /// [s] over which means were taken; NaN where unknown.
    struct Weights {
        double time = 0.0, view = 0.0, tube = 0.0;
    };
    AttemptMetrics metrics;
    Weights weights;
    bool passed_glottis = false;
};

/// The run's metrics, aggregated as metric_fields specify: maxima, sums, time-weighted means. NaN for a mean
/// of several attempts whose weights are unknown.
[[nodiscard]] AttemptMetrics combine(std::span<const RunPart> parts);

}  // namespace eti
