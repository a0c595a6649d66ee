// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/math/transform.hpp"

namespace eti::render {

/// Smooth noise, 0-1, whose values on the lattice of integers are independent.
[[nodiscard]] float value_noise(const Vec3f& p);

}  // namespace eti::render
