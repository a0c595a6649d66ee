// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/model/live_measures.hpp"

#include <algorithm>

#include "common/math/units.hpp"

namespace eti {

namespace {

constexpr bool peaks = true, latest = false, optional = true, required = false;
constexpr float none = LiveMeasures::missing;

constexpr LiveMeasureField live_measure_rows[] = {
    // The mean maxima of Xiao et al. 2020, Table 2, are 3.1 to 5.3 N.
    {"gum_force_now", &LiveMeasures::gum_force_n, "force on the upper gum", "gum force", "N", "N", 1.0f, 0.0f,
     6.0f, 2.0f, 4.0f, peaks, required, "force on the upper gum"},
    {"glottic_opening_now", &LiveMeasures::glottic_opening_percent, "glottis in sight", "glottis seen", "%",
     "%", 1.0f, 0.0f, 100.0f, none, none, peaks, required, "visible share of the glottic opening"},
    // A tube outside the mouth may be anywhere.
    {"tube_depth_past_glottis", &LiveMeasures::tube_depth_past_glottis, "tube past the glottis",
     "tube past cords", "m", "cm", centimetre, -5.0f, 4.0f, none, none, latest, required,
     "depth of the tube's tip past the glottis, negative before it"},
    {"tube_force_now", &LiveMeasures::tube_force_n, "force of the tube on the hand", "tube force", "N", "N",
     1.0f, 0.0f, 2.0f, none, none, peaks, optional,
     "force of the tube on the hand that holds it, mean over the step"},
    {"tongue_force_now", &LiveMeasures::tongue_force_n, "force on the tongue", "tongue force", "N", "N", 1.0f,
     0.0f, 10.0f, none, none, peaks, optional, "force on the tongue now"},
    {"epiglottis_in_sight", &LiveMeasures::epiglottis_in_sight, "epiglottis in sight", "", "", "", 1.0f, 0.0f,
     0.0f, none, none, latest, optional,
     "1 if the last view showed the epiglottis, which is tested only with nothing of the opening in sight"},
    // Limits of severe events in neonatal airway registries (Herrick et al. 2020, Neonatology 117:65).
    {"oxygen_saturation_now", &LiveMeasures::oxygen_saturation_percent, "oxygen saturation",
     "oxygen saturation", "%", "%", 1.0f, 0.0f, 100.0f, 90.0f, 80.0f, latest, optional,
     "oxygen saturation as displayed; NaN if not simulated"},
    {"heart_rate_now", &LiveMeasures::heart_rate_per_min, "heart rate", "heart rate", "1/min", "1/min", 1.0f,
     0.0f, 200.0f, 100.0f, 60.0f, latest, optional, "heart rate; NaN if not simulated"},
};

}  // namespace

constinit const std::span<const LiveMeasureField> live_measure_fields = live_measure_rows;

const LiveMeasureField& live_measure(float LiveMeasures::*value) {
    return *std::ranges::find(live_measure_fields, value, &LiveMeasureField::value);
}

}  // namespace eti
