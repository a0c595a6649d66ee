// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>

#include "common/model/tools.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// A device that does not exist or cannot be opened; the text says what to do.
class DeviceError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// What a driver needs to open its device.
struct SensorSetup {
    Tool tool = Tool::laryngoscope;
    std::optional<OperatorScript> script;  ///< for scripted hands; without it they hold still
    float tool_length = 0.1f;              ///< [m], from the tool frame's origin to its tip
    float curvature = 0.0f;                ///< [1/m], of a tube; see TrackPlayer
    Observation start;                     ///< what the scripted hand sees first
};

/// A row of the table of drivers; a new device is a new row.
struct Driver {
    std::string_view name;
    Tool tool;  ///< the tool it moves: haptic devices the laryngoscope
    std::string_view description;
    std::unique_ptr<Sensor> (*open)(const SensorSetup& setup);
};

[[nodiscard]] std::span<const Driver> drivers();

/// The driver of that name for `tool`. Throws DeviceError naming those there are.
[[nodiscard]] const Driver& driver_named(std::string_view name, Tool tool);

}  // namespace eti::devices
