// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A tool controlled by mouse and keys in a small window, as seen by an operator at the patient's head.
/// Dragging with the left button moves it sideways and up, dragging with the right button turns it, the wheel
/// moves it in and out. Keys A D R F W S move, J L I K U O turn; the space bar is suction.
[[nodiscard]] std::unique_ptr<Sensor> open_mouse(const SensorSetup& setup);

}  // namespace eti::devices
