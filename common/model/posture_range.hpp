// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/units.hpp"

namespace eti {

// Range of motion of head, jaw and table; head and jaw from 0, the table in both directions [deg].
inline constexpr float max_head_elevation_deg = 30.0f;
inline constexpr float max_jaw_opening_deg = 35.0f;
inline constexpr float max_table_angle_deg = 20.0f;

// The same [rad].
inline constexpr float max_head_elevation = max_head_elevation_deg * degree;
inline constexpr float max_jaw_opening = max_jaw_opening_deg * degree;
inline constexpr float max_table_angle = max_table_angle_deg * degree;

}  // namespace eti
