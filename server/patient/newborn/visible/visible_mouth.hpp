// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/patient/newborn/mouth.hpp"

// Drawn mouth in the newborn's model coordinates: x left, y anterior, z superior; millimetres of the 3.5 kg
// term newborn. For particles and shell see mouth.hpp.
namespace eti::patient {

/// Alveolar ridges with their segments.
[[nodiscard]] Gums visible_gums(const Vec3f& p, const Vec3f& in_jaw);

/// Hard palate with its rugae, soft palate, uvula and the arches beside it. `tongue`: distance from the drawn
/// tongue at rest, on which the soft palate lies.
[[nodiscard]] float visible_palate(const Vec3f& p, float tongue);

/// Air that the throat has besides, so that a large tongue does not press the soft palate into its wall.
[[nodiscard]] float room_of_velum(const Vec3f& p, float tongue);

/// The tongue with its sulcus and frenulum. `in_tongue`: in the coordinates of a standard closed jaw.
[[nodiscard]] float visible_tongue(const Vec3f& in_tongue, float scale);

}  // namespace eti::patient
