// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/attempt_metrics.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

namespace eti {

namespace {

using enum Aggregation;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

constexpr MetricField metric_rows[] = {
    {"gum_force_n.max", "force on the upper gum, maximum", "N", &AttemptMetrics::gum_force_max_n, true, 0,
     greatest,
     "Sum of the normal forces of the blade's contacts with the shell's upper gum, plus the net force of its "
     "tissue particles: maximum",
     "No published value; trainees on a simulator exerted 3.1 to 5.3 N (Xiao et al. 2020, Table 2)"},
    {"gum_force_n.mean", "force on the upper gum, mean", "N", &AttemptMetrics::gum_force_mean_n, true, 0,
     time_mean, "Mean of the same force over the whole attempt, including time without contact"},
    {"blade_depth_cm.max", "blade depth past the gum, maximum", "cm", &AttemptMetrics::blade_depth_max_cm,
     true, 0, greatest, "Straight distance from the midpoint of the upper gum to the blade's tip, maximum"},
    {"blade_depth_cm.mean", "blade depth past the gum, mean", "cm", &AttemptMetrics::blade_depth_mean_cm,
     true, 0, time_mean, "Mean of the same distance over the attempt"},
    {"pitch_peaks", "pitch peaks", "", &AttemptMetrics::pitch_peaks, true, 0, sum,
     "Maxima of the pitch curve with a prominence of at least 5 deg. Prominence is the height above the "
     "higher of the two lowest points that separate the maximum from higher ground or from the curve's end"},
    {"yaw_peaks", "yaw peaks", "", &AttemptMetrics::yaw_peaks, true, 0, sum,
     "As for pitch: the larger of the counts for left and right"},
    {"pitch_rocking_deg", "pitch rocking", "deg", &AttemptMetrics::pitch_rocking_deg, true, 0, greatest,
     "Largest difference between the pitch curve and its wavelet-denoised version, see below"},
    {"yaw_rocking_deg", "yaw rocking", "deg", &AttemptMetrics::yaw_rocking_deg, true, 0, greatest,
     "As for pitch"},
    {"attempts", "attempts", "", &AttemptMetrics::attempts, true, 0, sum, "One per attempt",
     "1: the risk of adverse events grows with each further attempt (Singh et al. 2022, J Perinatol, "
     "doi:10.1038/s41372-022-01484-5)"},
    {"time_s", "time", "s", &AttemptMetrics::time_s, true, 0, sum, "From beginning to end of the attempt",
     "At most 30 s (Lane et al. 2004, J Pediatr 145:67)"},
    {"glottic_opening_percent.max", "glottic opening seen, maximum", "%",
     &AttemptMetrics::glottic_opening_max_percent, true, 0, greatest,
     "Share of the glottic opening visible to the eye (POGO), see below: maximum"},
    {"glottic_opening_percent.mean", "glottic opening seen, mean", "%",
     &AttemptMetrics::glottic_opening_mean_percent, true, 0, view_mean,
     "Mean of the same share, from the first view until the tube's tip is within 6 mm of the glottis or past "
     "it; 0 if the glottis was never seen"},
    {"tube_speed_cm_per_s.max", "tube tip speed, maximum", "cm/s", &AttemptMetrics::tube_speed_max_cm_per_s,
     true, unknown, greatest,
     "Speed of the tube's tip while it is inside the mouth, from displacements over 1/30 s: maximum"},
    {"tube_speed_cm_per_s.mean", "tube tip speed, mean", "cm/s", &AttemptMetrics::tube_speed_mean_cm_per_s,
     true, unknown, tube_mean, "Mean of the same speed over the time inside the mouth"},
    {"head_elevation_deg", "head elevation", "deg", &AttemptMetrics::head_elevation_deg, true, 0, passage,
     "Rotation of the skull about the upper-neck joint, chin up, when the tube passes the glottis; without a "
     "passage, at the best view; without a view, when the blade entered"},
    {"oesophageal_entries", "oesophageal entries", "", &AttemptMetrics::oesophageal_entries, true, 0, sum,
     "Number of times the tube's tip entered the oesophagus, see below", "0"},
    {"tube_depth_at_lip_cm", "tube depth at the lip", "cm", &AttemptMetrics::tube_depth_at_lip_cm, false,
     unknown, last,
     "Length of the tube's centre line from its tip back to the plane of the mouth opening, at the attempt's "
     "end",
     "`tube_depth_rule_cm`"},
    {"tube_depth_rule_cm", "tube depth by the weight rule", "cm", &AttemptMetrics::tube_depth_rule_cm, false,
     0, last,
     "Weight [kg] + 6 cm (the rule places the tip mid-tracheal in about half of newborns: Peng et al. 2020, "
     "Front Pediatr 8:367)"},
    {"main_stem_entries", "main-stem entries", "", &AttemptMetrics::main_stem_entries, false, 0, sum,
     "Number of times the tube's tip passed the carina", "0"},
    {"cormack_lehane_grade", "Cormack-Lehane grade", "", &AttemptMetrics::cormack_lehane_grade, false, 4,
     least,
     "From the best view (Cormack & Lehane 1984, Anaesthesia 39:1105): 1 most of the glottis, taken as half "
     "or more; 2 a part of it; 3 the epiglottis only; 4 neither. The threshold of \"most\" is chosen: the "
     "original gives no number",
     "1"},
    {"over_time_limit", "over the time limit", "", &AttemptMetrics::over_time_limit, false, 0, greatest,
     "1 if the attempt took longer than the scenario's limit (30 s by default)", "0"},
    {"time_to_first_view_s", "time to the first view of the glottis", "s",
     &AttemptMetrics::time_to_first_view_s, false, unknown, least,
     "From the attempt's beginning until the eye first sees a part of the glottis; undefined if it never "
     "does"},
    {"epiglottis_force_n.max", "force on the epiglottis, maximum", "N",
     &AttemptMetrics::epiglottis_force_max_n, false, 0, greatest,
     "Largest net force between the blade and the epiglottis"},
    {"tongue_force_n.max", "force on the tongue, maximum", "N", &AttemptMetrics::tongue_force_max_n, false, 0,
     greatest, "Largest net force between the blade and the tongue"},
    {"gum_impulse_n_s", "force on the upper gum over time", "N s", &AttemptMetrics::gum_impulse_n_s, false, 0,
     sum, "The force on the upper gum, integrated over the attempt"},
    {"epiglottis_impulse_n_s", "force on the epiglottis over time", "N s",
     &AttemptMetrics::epiglottis_impulse_n_s, false, 0, sum,
     "The force on the epiglottis, integrated over the attempt"},
    {"tongue_impulse_n_s", "force on the tongue over time", "N s", &AttemptMetrics::tongue_impulse_n_s, false,
     0, sum, "The force on the tongue, integrated over the attempt"},
    {"view_held_s", "time with half the glottis visible", "s", &AttemptMetrics::view_held_s, false, 0, sum,
     "Time with at least half of the opening visible, until the tube's tip is within 6 mm of the glottis or "
     "past it. Grade 1 begins at half"},
    {"tube_grip_speed_cm_per_s.max", "speed of the tube at the hand, maximum", "cm/s",
     &AttemptMetrics::tube_grip_speed_max_cm_per_s, false, unknown, greatest,
     "Speed of the tube where the hand holds it, while its tip is inside the mouth, from displacements over "
     "1/30 s: maximum. A tip much faster than this has slipped or sprung back"},
    {"tube_grip_speed_cm_per_s.mean", "speed of the tube at the hand, mean", "cm/s",
     &AttemptMetrics::tube_grip_speed_mean_cm_per_s, false, unknown, tube_mean,
     "Mean of the same speed over the time inside the mouth"},
    {"blade_path_length_cm", "path of the blade's tip", "cm", &AttemptMetrics::blade_path_length_cm, false, 0,
     sum, "Path length of the blade's tip, summed over intervals of 1/30 s"},
    {"blade_smoothness", "smoothness of the blade's tip (log dimensionless jerk)", "",
     &AttemptMetrics::blade_smoothness, false, unknown, time_mean,
     "Log dimensionless jerk of the blade tip's speed, see below"},
    {"oxygen_saturation_percent.min", "oxygen saturation, minimum", "%",
     &AttemptMetrics::oxygen_saturation_min_percent, false, unknown, least,
     "Oxygen saturation as a pulse oximeter shows it: minimum during the attempt; only with `vital_signs: "
     "on`, like the next three",
     "No fall by 20 points or more (Herrick et al. 2020, Neonatology 117:65)"},
    {"oxygen_saturation_percent.end", "oxygen saturation at the end", "%",
     &AttemptMetrics::oxygen_saturation_end_percent, false, unknown, last,
     "The same at the attempt's end; the current value during the attempt"},
    {"heart_rate_per_min.min", "heart rate, minimum", "1/min", &AttemptMetrics::heart_rate_min_per_min, false,
     unknown, least, "Heart rate, minimum during the attempt", "At least 100 (the same)"},
    {"heart_rate_per_min.end", "heart rate at the end", "1/min", &AttemptMetrics::heart_rate_end_per_min,
     false, unknown, last, "The same at the attempt's end; the current value during the attempt"},
};

}  // namespace

constinit const std::span<const MetricField> metric_fields = metric_rows;

const MetricField& metric_field(std::string_view key) {
    return *std::ranges::find(metric_fields, key, &MetricField::key);
}

std::string_view describe(Aggregation combine) {
    constexpr std::string_view words[] = {"greatest",
                                          "least",
                                          "sum",
                                          "mean over time",
                                          "mean over time of sight",
                                          "mean over time in the mouth",
                                          "at the last passage",
                                          "at the end"};
    return words[static_cast<std::size_t>(combine)];
}

bool depends_only_on_tool_poses(const MetricField& field) {
    constexpr std::string_view keys[] = {"blade_depth_cm.max",
                                         "blade_depth_cm.mean",
                                         "pitch_peaks",
                                         "yaw_peaks",
                                         "pitch_rocking_deg",
                                         "yaw_rocking_deg",
                                         "attempts",
                                         "time_s",
                                         "tube_speed_cm_per_s.max",
                                         "tube_speed_cm_per_s.mean",
                                         "over_time_limit",
                                         "tube_grip_speed_cm_per_s.max",
                                         "tube_grip_speed_cm_per_s.mean",
                                         "blade_path_length_cm",
                                         "blade_smoothness"};
    return std::ranges::find(keys, field.key) != std::end(keys);
}

AttemptMetrics initial_metrics() {
    AttemptMetrics metrics;
    for (const MetricField& field : metric_fields) {
        metrics.*field.value = field.start;
    }
    return metrics;
}

}  // namespace eti
