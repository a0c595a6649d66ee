// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/outcome_tracker.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/model/thresholds.hpp"

namespace eti::metrics {
namespace {

double in_mm(float metres) {
    return 1e3 * static_cast<double>(metres);
}

std::string failure_reason(const OutcomeTracker& tracker, const AirwayWatch& tube) {
    const std::string view = fmt::format("best view {:.0f} %", tracker.best_opening_percent);
    if (tube.in_oesophagus()) {
        return fmt::format("the tube went into the oesophagus at {:.1f} s",
                           tracker.entered_oesophagus.value_or(0.0));
    }
    if (tracker.left_trachea) {
        return fmt::format("the tube had reached the trachea but slipped out at {:.1f} s",
                           *tracker.left_trachea);
    }
    if (tracker.entered_oesophagus) {
        return fmt::format(
            "the tube went into the oesophagus at {:.1f} s and did not reach the trachea afterwards",
            *tracker.entered_oesophagus);
    }
    if (!tracker.blade_entered) {
        return "the blade never entered the mouth";
    }
    if (tracker.best_opening_percent < threshold::least_view.value) {
        return fmt::format("the glottis was never seen ({})", view);
    }
    if (!tracker.tube_entered_mouth) {
        return fmt::format("the tube never entered the mouth ({})", view);
    }
    return fmt::format("the tube's tip came no nearer than {:.0f} mm to the glottis ({})",
                       in_mm(tracker.nearest_to_glottis), view);
}

}  // namespace

void OutcomeTracker::add(const AirwayWatch& tube, const AirwayWatch::Changes& changes, double opening_percent,
                         double time) {
    best_opening_percent = std::max(best_opening_percent, opening_percent);
    tube_entered_mouth = tube_entered_mouth || tube.in_mouth();
    if (!tube.in_trachea()) {
        nearest_to_glottis = std::min(nearest_to_glottis, -tube.past_glottis());
    }
    if (tube.in_oesophagus() && !entered_oesophagus) {
        entered_oesophagus = time;
    }
    if (changes.trachea == GateTracker::Change::out) {
        left_trachea = time;
    }
}

Outcome evaluate_outcome(const OutcomeTracker& tracker, const AirwayWatch& tube, float trachea_length,
                         double time_limit) {
    constexpr float success_depth = threshold::success_depth.as_float();
    Outcome outcome;
    const float past = tube.past_glottis();
    if (!tube.in_trachea()) {
        outcome.reason = failure_reason(tracker, tube);
    } else if (tube.in_main_stem()) {
        outcome.reason = fmt::format("the tube's tip lies {:.0f} mm past the carina, in a main bronchus",
                                     in_mm(past - trachea_length));
    } else if (past < success_depth) {
        outcome.reason =
            fmt::format("the tube's tip lies only {:.0f} mm past the glottis, and {:.0f} mm are required",
                        in_mm(past), in_mm(success_depth));
    } else {
        outcome.success = true;
        outcome.reason =
            fmt::format("the tube's tip lies {:.0f} mm past the glottis, {:.0f} mm above the carina",
                        in_mm(past), std::max(0.0, in_mm(trachea_length - past)));
    }
    if (tracker.duration > time_limit) {
        outcome.reason +=
            fmt::format("; it took {:.1f} s, over the limit of {:.0f} s", tracker.duration, time_limit);
    }
    return outcome;
}

}  // namespace eti::metrics
