// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <limits>
#include <optional>

#include "common/model/parameters.hpp"
#include "server/metrics/airway_watch.hpp"

namespace eti::metrics {

/// What happened to the tube, in an attempt or in a run; enough to say how it ended and why.
struct Story {
    bool blade_entered = false;
    bool tube_entered_mouth = false;
    double best_opening_percent = 0.0;
    float nearest_to_glottis =
        std::numeric_limits<float>::infinity();  ///< [m], of the tip outside the trachea
    std::optional<double> entered_oesophagus;    ///< [s] since the run began, first time
    std::optional<double> left_trachea;          ///< [s], last time
    double duration = 0.0;                       ///< [s]

    void add(const AirwayWatch& tube, const AirwayWatch::Changes& changes, double opening_percent,
             double time);
};

/// Success when the tip lies in the trachea: threshold::success_depth or more past the glottis and above
/// the carina. The reason is one sentence without a full stop, on success too.
[[nodiscard]] Outcome judge(const Story& story, const AirwayWatch& tube, float trachea_length,
                            double time_limit);

}  // namespace eti::metrics
