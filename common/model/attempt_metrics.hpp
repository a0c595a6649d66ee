// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace eti {

/// The performance metrics: the twelve performance parameters of Xiao et al. 2020, Table 2, and those beyond
/// the paper. Units as in the names; definitions in docs/metrics.md. NaN where a value does not exist for an
/// attempt (a tube that never entered the mouth has no speed).
struct AttemptMetrics {
    double gum_force_max_n = 0, gum_force_mean_n = 0;
    double blade_depth_max_cm = 0, blade_depth_mean_cm = 0;
    double pitch_peaks = 0, yaw_peaks = 0;
    double pitch_rocking_deg = 0, yaw_rocking_deg = 0;
    double attempts = 0;
    double time_s = 0;
    double glottic_opening_max_percent = 0, glottic_opening_mean_percent = 0;
    double tube_speed_max_cm_per_s = 0, tube_speed_mean_cm_per_s = 0;
    double head_elevation_deg = 0;
    double oesophageal_entries = 0;
    // Beyond the paper.
    double tube_depth_at_lip_cm = 0, tube_depth_rule_cm = 0;
    double main_stem_entries = 0;
    double cormack_lehane_grade = 0;
    double over_time_limit = 0;  ///< 1 when the attempt took longer than 30 s
    double time_to_first_view_s = 0;
    double epiglottis_force_max_n = 0, tongue_force_max_n = 0;
    double gum_impulse_n_s = 0, epiglottis_impulse_n_s = 0, tongue_impulse_n_s = 0;
    double view_held_s = 0;
    double tube_grip_speed_max_cm_per_s = 0, tube_grip_speed_mean_cm_per_s = 0;
    double blade_path_length_cm = 0;
    double blade_smoothness = 0;  ///< log dimensionless jerk: closer to zero is smoother
    double oxygen_saturation_min_percent = 0, oxygen_saturation_end_percent = 0;
    double heart_rate_min_per_min = 0, heart_rate_end_per_min = 0;
};

/// How a run's value is computed from those of its attempts.
enum class Aggregation : std::uint8_t {
    greatest,
    least,
    sum,
    time_mean,  ///< mean weighted by the time of the attempts
    view_mean,  ///< mean weighted by the time from first sight of the glottis to the tube's arrival
    tube_mean,  ///< mean weighted by the time of the tube in the mouth
    passage,    ///< of the last attempt that passed the glottis, else of the one with the best view
    last,       ///< of the last attempt, unless the run itself has a value
};

[[nodiscard]] std::string_view describe(Aggregation combine);

/// One row of the table of metrics: where a value is stored in JSON and files, how it is displayed, its
/// initial value, and how a run aggregates its attempts.
struct MetricField {
    std::string_view key;  ///< JSON key; "name.max" and "name.mean" become an object with two members
    std::string_view label;
    std::string_view unit;
    double AttemptMetrics::*value;
    bool in_paper;
    double start;  ///< NaN: no value until something is measured
    Aggregation combine;
    std::string_view definition;
    std::string_view norm = {};  ///< the aim, with its source; empty where none is known
};

/// Every metric, in display order. JSON, the session file, the bus, the run's values, the printed table and
/// that of docs/metrics.md all iterate over this list, so a metric is added in one place.
extern const std::span<const MetricField> metric_fields;

/// The row of a key, which must be in the table.
[[nodiscard]] const MetricField& metric_field(std::string_view key);

/// Whether a metric depends only on the poses of laryngoscope and tube in a rigid patient. The others need
/// tissue, a view or the tube's course inside. Eight of the paper's twelve depend only on poses.
[[nodiscard]] bool depends_only_on_tool_poses(const MetricField& field);

/// Whether tissue, view, the tube's course and the outcome were measured; on a manikin they are not. The
/// oesophageal-entry count exists exactly when they were.
[[nodiscard]] inline bool airway_measured(const AttemptMetrics& metrics) {
    return !std::isnan(metrics.oesophageal_entries);
}

/// Every metric before anything has happened.
[[nodiscard]] AttemptMetrics initial_metrics();

/// How a run or an attempt ended.
struct Outcome {
    bool success = false;
    std::string reason;  ///< one sentence, also on success
    bool known = true;   ///< whether it was measured; otherwise `success` is meaningless
};

}  // namespace eti
