// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/tools.hpp"

namespace eti {

/// Where the camera on the blade looks from [m], tool frame: a millimetre before the bulb, which would stand
/// in its way, in the channel beneath the blade.
[[nodiscard]] inline Vec3f lens_of(const Laryngoscope& scope) {
    return {0.0f, -4.2e-3f, scope.blade_length - 15e-3f};
}

}  // namespace eti
