// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <array>

#include "server/anatomy/patient.hpp"

namespace eti::anatomy {

/// Whether all corners of a tetrahedron are particles of one tissue: of such the solver's meshes are made.
[[nodiscard]] inline bool made_of(Tissue tissue, const std::array<std::uint32_t, 4>& corners,
                                  const ParticleSet& set) {
    return std::ranges::all_of(corners, [&](std::uint32_t i) { return set.tissue[i] == tissue; });
}

}  // namespace eti::anatomy
