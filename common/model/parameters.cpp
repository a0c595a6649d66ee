// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/parameters.hpp"

namespace eti {

const std::array<ParameterField, 25> parameter_fields = {{
    {"gum_force_n.max", "force on the upper gum, greatest", "N", &Parameters::gum_force_max_n, true},
    {"gum_force_n.mean", "force on the upper gum, mean", "N", &Parameters::gum_force_mean_n, true},
    {"blade_depth_cm.max", "blade depth past the gum, greatest", "cm", &Parameters::blade_depth_max_cm, true},
    {"blade_depth_cm.mean", "blade depth past the gum, mean", "cm", &Parameters::blade_depth_mean_cm, true},
    {"pitch_peaks", "pitch peaks", "", &Parameters::pitch_peaks, true},
    {"yaw_peaks", "yaw peaks", "", &Parameters::yaw_peaks, true},
    {"pitch_rocking_deg", "pitch rocking", "deg", &Parameters::pitch_rocking_deg, true},
    {"yaw_rocking_deg", "yaw rocking", "deg", &Parameters::yaw_rocking_deg, true},
    {"attempts", "attempts", "", &Parameters::attempts, true},
    {"time_s", "time", "s", &Parameters::time_s, true},
    {"glottic_opening_percent.max", "glottic opening seen, greatest", "%",
     &Parameters::glottic_opening_max_percent, true},
    {"glottic_opening_percent.mean", "glottic opening seen, mean", "%",
     &Parameters::glottic_opening_mean_percent, true},
    {"tube_speed_cm_per_s.max", "tube tip speed, greatest", "cm/s", &Parameters::tube_speed_max_cm_per_s,
     true},
    {"tube_speed_cm_per_s.mean", "tube tip speed, mean", "cm/s", &Parameters::tube_speed_mean_cm_per_s, true},
    {"head_elevation_deg", "head elevation", "deg", &Parameters::head_elevation_deg, true},
    {"oesophageal_entries", "oesophageal entries", "", &Parameters::oesophageal_entries, true},
    {"tube_depth_at_lip_cm", "tube depth at the lip", "cm", &Parameters::tube_depth_at_lip_cm, false},
    {"tube_depth_rule_cm", "tube depth by the weight rule", "cm", &Parameters::tube_depth_rule_cm, false},
    {"main_stem_entries", "main-stem entries", "", &Parameters::main_stem_entries, false},
    {"cormack_lehane_grade", "Cormack-Lehane grade", "", &Parameters::cormack_lehane_grade, false},
    {"over_time_limit", "over the time limit", "", &Parameters::over_time_limit, false},
    {"epiglottis_force_n.max", "force on the epiglottis, greatest", "N", &Parameters::epiglottis_force_max_n,
     false},
    {"tongue_force_n.max", "force on the tongue, greatest", "N", &Parameters::tongue_force_max_n, false},
    {"blade_path_length_cm", "path of the blade's tip", "cm", &Parameters::blade_path_length_cm, false},
    {"blade_smoothness", "smoothness of the blade's tip (spectral arc length)", "",
     &Parameters::blade_smoothness, false},
}};

}  // namespace eti
