// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <numbers>

namespace eti {

// All internal quantities are SI; these convert only where a person types or reads a number.
inline constexpr float millimetre = 1e-3f;
inline constexpr float centimetre = 1e-2f;
inline constexpr float degree = std::numbers::pi_v<float> / 180.0f;

}  // namespace eti
