// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// Keys of the terminal as if they were a pad: the arrows deflect axes 0 and 1, '[' and ']' axis 4, for a
/// tenth of a second each; 's' switches button 0 on and off.
[[nodiscard]] std::unique_ptr<Sensor> open_keyboard(const SensorSetup& setup);

}  // namespace eti::devices
