// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A 6-DOF mouse by spacenavd. Its cap sets the tool's velocity as somebody at the patient's head sees
/// it: fully pushed 10 cm/s and 60 deg/s.
[[nodiscard]] std::unique_ptr<Sensor> open_spacenav(const SensorSetup& setup);

}  // namespace eti::devices
