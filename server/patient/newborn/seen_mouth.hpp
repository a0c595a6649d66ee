// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/newborn/mouth.hpp"

// Mouth as one sees it, in the newborn's model coordinates: x left, y anterior, z superior; millimetres of
// the 3.5 kg term newborn. Where particles and shell have it: mouth.hpp.
namespace eti::anatomy {

/// Alveolar ridges with their segments.
[[nodiscard]] Gums seen_gums(const Vec3f& p, const Vec3f& in_jaw);

/// Hard palate with its rugae, soft palate, uvula and the arches beside it.
[[nodiscard]] float seen_palate(const Vec3f& p);

/// The tongue with its sulcus and frenulum. `in_tongue`: in the coordinates of a closed usual jaw.
[[nodiscard]] float seen_tongue(const Vec3f& in_tongue, float scale);

}  // namespace eti::anatomy
