// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A 6-DOF mouse by spacenavd. Its cap sets the tool's velocity in the operator frame: 10 cm/s and 60 deg/s
/// at full deflection.
[[nodiscard]] std::unique_ptr<Sensor> open_spacenav(const SensorSetup& setup);

}  // namespace eti::devices
