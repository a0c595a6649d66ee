// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// A dimension of a model, with the published range for newborns.
struct Dimension {
    std::string name;
    double value = 0.0;
    std::string unit;
    double low = 0.0, high = 0.0;  ///< published, for this patient; both 0 if unknown
    std::string source;
    [[nodiscard]] bool known() const { return high > 0.0; }
    [[nodiscard]] bool within() const { return !known() || (value >= low && value <= high); }
};

/// Measures a model. Published values of term newborns are scaled by the cube root of the patient's weight. A
/// value out of range is not an error: variants are out of range on purpose.
[[nodiscard]] std::vector<Dimension> measure(const Patient& patient, float gestational_age);

/// Angles between the axes of mouth, pharynx and larynx [rad].
struct AxisAngles {
    float mouth_pharynx = 0.0f;   ///< alpha of Adnet et al. 2001
    float pharynx_larynx = 0.0f;  ///< beta
    float sight_larynx = 0.0f;    ///< delta: line of sight past the upper gum against the larynx
};
struct Alignment {
    float head_elevation = 0.0f;  ///< [rad], 0-30 deg, at which the axes are best aligned
    float off_line = 0.0f;        ///< [m], RMS distance of the axes' points from the fitted line
    AxisAngles angles;            ///< at that elevation
    AxisAngles angles_at_rest;    ///< at zero elevation
};

/// Finds the head elevation at which mouth opening, pharynx (at the epiglottis's tip), glottis and mid
/// trachea are most nearly collinear, with the mouth open by `jaw_opening` [rad].
[[nodiscard]] Alignment align_axes(const Patient& patient, float jaw_opening);

}  // namespace eti::patient
