// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/patient/model/patient.hpp"

namespace eti::patient {

/// Indices of the patient's tetrahedra whose corners are all particles of one tissue; the solver's meshes
/// consist of such.
[[nodiscard]] inline std::vector<std::uint32_t> tetrahedra_of(Tissue tissue, const Patient& patient) {
    std::vector<std::uint32_t> those;
    for (std::uint32_t t = 0; t < patient.tetrahedra.corners.size(); ++t) {
        if (std::ranges::all_of(patient.tetrahedra.corners[t],
                                [&](std::uint32_t i) { return patient.particles.tissue[i] == tissue; })) {
            those.push_back(t);
        }
    }
    return those;
}

}  // namespace eti::patient
