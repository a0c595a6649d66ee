// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <string>
#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::anatomy {

/// A measure of a model beside what was published of newborns.
struct Dimension {
    std::string name;
    double value = 0.0;
    std::string unit;
    double low = 0.0, high = 0.0;  ///< published, for this patient; both 0 where nothing is known
    std::string source;
    [[nodiscard]] bool known() const { return high > 0.0; }
    [[nodiscard]] bool within() const { return !known() || (value >= low && value <= high); }
};

/// Measures a model. Figures of term newborns are carried to the patient's weight by its cube root. Being out
/// of a range is no fault of a model: variants are meant to be.
[[nodiscard]] std::vector<Dimension> measure(const Patient& patient, float gestational_age);

/// How the axes of mouth, pharynx and larynx lie to each other [rad].
struct AxisAngles {
    float mouth_pharynx = 0.0f;   ///< alpha of Adnet et al. 2001
    float pharynx_larynx = 0.0f;  ///< beta
    float sight_larynx = 0.0f;    ///< delta: line of sight past the upper gum against the larynx
};
struct Alignment {
    float head_elevation = 0.0f;  ///< [rad], 0-30 deg, at which the axes come closest to one line
    float off_line = 0.0f;        ///< [m], root mean square distance of the axes' points from that line
    AxisAngles angles;            ///< there
    AxisAngles angles_at_rest;    ///< with the head not raised
};

/// Looks for the head elevation at which mouth opening, pharynx (at the epiglottis's tip), glottis and middle
/// of the trachea lie closest to one line, the mouth open by `jaw_opening` [rad].
[[nodiscard]] Alignment align_axes(const Patient& patient, float jaw_opening);

}  // namespace eti::anatomy
