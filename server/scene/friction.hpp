// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/pbd/contact/friction.hpp"

namespace eti::scene {

/// Coulomb friction coefficients of wet mucosa against other materials.
inline constexpr pbd::Friction mucosa_on_steel(0.1f);
inline constexpr pbd::Friction mucosa_on_mucosa(0.2f);
inline constexpr pbd::Friction mucosa_on_tube(0.05f);

}  // namespace eti::scene
