// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <limits>
#include <optional>

#include "common/model/attempt_metrics.hpp"
#include "server/metrics/airway_watch.hpp"

namespace eti::metrics {

/// The tube's history in an attempt or a run: what its outcome and the reason for it are derived from.
struct OutcomeTracker {
    bool blade_entered = false;
    bool tube_entered_mouth = false;
    double best_opening_percent = 0.0;
    float nearest_to_glottis =
        std::numeric_limits<float>::infinity();  ///< [m], minimum over tip positions outside the trachea
    std::optional<double> entered_oesophagus;    ///< [s] since the run began, first entry
    std::optional<double> left_trachea;          ///< [s] since the run began, latest exit
    double duration = 0.0;                       ///< [s]

    void add(const AirwayWatch& tube, const AirwayWatch::Changes& changes, double opening_percent,
             double time);
};

/// Success means that the tip lies in the trachea: threshold::success_depth or more past the glottis and
/// above the carina. The reason is one sentence without a full stop, also on success.
[[nodiscard]] Outcome evaluate_outcome(const OutcomeTracker& tracker, const AirwayWatch& tube,
                                       float trachea_length, double time_limit);

}  // namespace eti::metrics
