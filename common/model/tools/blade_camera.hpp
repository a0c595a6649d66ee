// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/tools/tools.hpp"

namespace eti {

/// Position of the camera on the blade [m], tool frame: in the channel beneath the blade, one millimetre
/// before the bulb, which would otherwise occlude the view.
[[nodiscard]] inline Vec3f blade_camera_position(const Laryngoscope& scope) {
    return {0.0f, -4.2e-3f, scope.blade_length - 15e-3f};
}

}  // namespace eti
