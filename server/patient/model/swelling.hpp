// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// Limits of the tongue's length relative to the built one, beyond which tetrahedra near the attachments
/// collapse.
inline constexpr float min_growth = 0.55f, max_growth = 1.5f;

/// Growth field of the tongue in the rest posture: displacement [m] per unit of growth in length, one per
/// particle of the patient, zero outside the tongue. It is the equilibrium of a linearly elastic tongue
/// (linear tetrahedra) with uniform growth strain, held where it is attached to bone and, by its links, to
/// the floor of the mouth. Independent of the modulus. Takes a tenth of a second.
[[nodiscard]] std::vector<Vec3f> tongue_swelling(const Patient& patient);

}  // namespace eti::patient
