// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>

#include "devices/sensor/drivers.hpp"

namespace eti::devices {

/// A tool moved by mouse and keys in a small window, as somebody at the patient's head sees it: dragging
/// with the left button moves it sideways and up, with the right button turns it, the wheel moves it in
/// and out; keys A D R F W S move, J L I K U O turn, the space bar is suction.
[[nodiscard]] std::unique_ptr<Sensor> open_mouse(const SensorSetup& setup);

}  // namespace eti::devices
