// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A 3D Systems (Geomagic, SensAble) device by the HD layer of OpenHaptics, whose servo thread drives the
/// cycle. `source`: the device's name in the vendor's configuration; empty: the default one. Poses are in the
/// device's frame: origin in its workspace, x right, y up, z towards the user.
[[nodiscard]] std::unique_ptr<Sensor> open_openhaptics(const SensorSetup& setup);

}  // namespace eti::devices
