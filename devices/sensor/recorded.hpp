// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// Plays back the tool of a session file at its simulation times. `source`: the file.
[[nodiscard]] std::unique_ptr<Sensor> open_recorded(const SensorSetup& setup);

}  // namespace eti::devices
