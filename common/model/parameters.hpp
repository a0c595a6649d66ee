// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace eti {

/// The performance parameters: the twelve of Xiao et al. 2020, Table 2, and those beyond it. Units as in the
/// names; the definitions stand in docs/metrics.md. NaN where a value does not exist for an attempt (a tube
/// that never entered the mouth has no speed).
struct Parameters {
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

/// How a run's value follows from those of its attempts.
enum class Combine : std::uint8_t {
    greatest,
    least,
    sum,
    time_mean,  ///< mean weighted by the time of the attempts
    view_mean,  ///< by the time from first sight of the glottis to the tube's arrival
    tube_mean,  ///< by the time of the tube in the mouth
    passage,    ///< of the last attempt in which the glottis was passed, else of the best view
    last,       ///< of the last attempt; where the run itself has a value, that one
};

[[nodiscard]] std::string_view words_of(Combine combine);

/// One row of the table of parameters: where a value lies in JSON and files, how it is shown, what it is
/// before anything has happened, and how a run combines its attempts.
struct ParameterField {
    std::string_view key;  ///< JSON key; "name.max" and "name.mean" become an object with two members
    std::string_view label;
    std::string_view unit;
    double Parameters::*value;
    bool in_paper;
    double start;  ///< NaN: has no value until something was measured
    Combine combine;
    std::string_view definition;
    std::string_view norm = {};  ///< what to aim at, with its source; empty where none is known
};

/// Every parameter, in the order of display. JSON, the session file, the bus, the run's values, the printed
/// table and that of docs/metrics.md all walk this list, so a parameter is added in one place.
extern const std::span<const ParameterField> parameter_fields;

/// The row of a key, which must be one of the table.
[[nodiscard]] const ParameterField& parameter_field(std::string_view key);

/// Whether a value follows from where laryngoscope and tube are in a patient that does not give way; the
/// others need tissue, a view or the tube's course within. Eight of the paper's twelve are of that kind.
[[nodiscard]] bool follows_from_tools(const ParameterField& field);

/// Whether tissue, view and the tube's course were measured, and with them the outcome; on a manikin they are
/// not. Of these an entry into the oesophagus is always counted.
[[nodiscard]] inline bool airway_measured(const Parameters& parameters) {
    return !std::isnan(parameters.oesophageal_entries);
}

/// Every parameter as it is before anything has happened.
[[nodiscard]] Parameters starting_parameters();

/// How a run or an attempt ended.
struct Outcome {
    bool success = false;
    std::string reason;  ///< one sentence, also on success
    bool known = true;   ///< whether anything measured it; else `success` says nothing
};

}  // namespace eti
