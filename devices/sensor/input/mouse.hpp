// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A hand moved by mouse and keys (HeldTool) in a small window, as seen by an operator at the patient's head.
/// Dragging with the left button moves the tool sideways and up, dragging with the right button turns it
/// about its tip, the wheel slides it in and out; hand_keys() lift and turn it, the space bar is suction.
[[nodiscard]] std::unique_ptr<Sensor> open_mouse(const SensorSetup& setup);

}  // namespace eti::devices
