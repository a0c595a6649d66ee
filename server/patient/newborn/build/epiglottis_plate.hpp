// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "server/patient/newborn/anatomy.hpp"

namespace eti::patient {

inline constexpr float plate_stiffening = 8.0f;

/// A node of the epiglottis's mesh.
struct PlateNode {
    Vec3f position;            ///< [m]
    float radius;              ///< [m]
    float volume;              ///< [m^3] of tissue that it stands for
    std::array<int, 3> index;  ///< right-handed: to the left, towards the tip, posterior (0 or 1)
};

/// Meshes the epiglottis as a plate one cell thick. Its nodes lie in columns through the plate, `spacing` [m]
/// apart; a column's two nodes divide the plate's thickness into quarters, and their balls reach its two
/// surfaces. So elements fill the middle half of the thickness at any spacing; they bend like the whole plate
/// if their modulus is plate_stiffening times its own.
[[nodiscard]] std::vector<PlateNode> epiglottis_plate(const Anatomy& anatomy, float spacing);

}  // namespace eti::patient
