// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// One sensor of an Ascension (NDI) 3D Guidance tracker: trakSTAR, medSAFE. `source`: the sensor's number,
/// from 0. Poses are in the transmitter's frame.
[[nodiscard]] std::unique_ptr<Sensor> open_trakstar(const SensorSetup& setup);

}  // namespace eti::devices
