// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A pad by the kernel's joystick interface. `source`: its device file; empty: /dev/input/js0. Axes and
/// buttons as numbered by the kernel.
[[nodiscard]] std::unique_ptr<Sensor> open_gamepad(const SensorSetup& setup);

}  // namespace eti::devices
