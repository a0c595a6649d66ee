// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// Terminal keys as a pad: the arrows deflect axes 0 and 1, '[' and ']' axis 4, 'v' and 'b' axis 3, 'j' and
/// 'l' axis 6, 'i' and 'k' axis 7, for a tenth of a second each; 's' toggles button 0.
[[nodiscard]] std::unique_ptr<Sensor> open_keyboard(const SensorSetup& setup);

}  // namespace eti::devices
