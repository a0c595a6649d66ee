// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "common/model/attempt_metrics.hpp"

namespace eti {

/// Status of a value relative to its aim. Unknown where the value does not exist or has no aim.
enum class AimStatus : std::uint8_t { unknown, reached, near, missed };

[[nodiscard]] std::string_view name_of(AimStatus light);

/// The moment of a session at which an aim counts as missed.
enum class AimMoment : std::uint8_t {
    crossed,         ///< the first step whose value violates the aim
    best_view,       ///< the best view of the glottis
    second_attempt,  ///< the start of the second attempt
    end,             ///< the end of the last attempt
};

/// An aim as numbers, for reports. The measured quantity is best small. The aim's text and source are in
/// MetricField::norm.
struct Aim {
    std::string_view key;  ///< of the metric
    /// The quantity to minimise. `first`: the metrics at the start of the session.
    double (*measure)(const AttemptMetrics& values, const AttemptMetrics& first);
    double reached;     ///< reached up to this value
    double near;        ///< nearly up to this; beyond: missed. Chosen unless `practise` says otherwise
    bool each_attempt;  ///< applies to each attempt; a run takes its worst one
    AimMoment moment;
    std::string_view practise;  ///< advice for practice; empty where another aim gives the same
};

/// Every aim, in the order of metric_fields.
extern const std::span<const Aim> aims;

/// 0 or less: reached; up to 1: nearly; more: missed. NaN where a value does not exist. Stays below 1 for an
/// aim that is never missed (`near` is infinite).
[[nodiscard]] double shortfall(const Aim& aim, const AttemptMetrics& values, const AttemptMetrics& first);

[[nodiscard]] AimStatus aim_status(double shortfall);

}  // namespace eti
