// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::anatomy {

/// Length over that of the built tongue, beyond which some tetrahedra near the attachments collapse.
inline constexpr float least_growth = 0.55f, most_growth = 1.5f;

/// Where the tongue's particles go, in the rest posture, when every part of it grows alike: displacement [m]
/// per unit of growth in length, one per particle of the patient, zero outside the tongue. It is the
/// equilibrium of a linearly elastic tongue (linear tetrahedra) with that strain in it, held where it
/// grows from bone and, by its links, to the floor of the mouth; its modulus does not matter. A tenth of a
/// second.
[[nodiscard]] std::vector<Vec3f> tongue_swelling(const Patient& patient);

}  // namespace eti::anatomy
