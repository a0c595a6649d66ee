// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/model/tools/parked_pose.hpp"
#include "devices/sensor/device_error.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// Parameters with which a driver opens its device.
struct SensorSetup {
    Tool tool = Tool::laryngoscope;
    std::optional<OperatorScript> script;  ///< for scripted hands; without it they hold still
    float tool_length = 0.1f;              ///< [m], from the tool frame's origin to its tip
    float curvature = 0.0f;                ///< [1/m], of a tube; see TrackPlayer
    Observation start;                     ///< first observation of the scripted hand
    std::string source{};                  ///< file, name or number of the device; empty: the default
    std::string library{};                 ///< path of the vendor's library; empty: its usual names
};

/// Role of a device: holding a tool, or giving commands.
enum class DeviceRole : std::uint8_t { tool, commands };

/// A row of the table of drivers; a new device is a new row.
struct Driver {
    std::string_view name;
    DeviceRole role;
    bool needs_calibration;  ///< its poses are in the device's own frame; see eti-calibrate
    std::string_view description;
    std::unique_ptr<Sensor> (*open)(const SensorSetup& setup);
};

[[nodiscard]] std::span<const Driver> drivers();

/// The driver of that name for `role`. Throws DeviceError naming the available ones.
[[nodiscard]] const Driver& find_driver(std::string_view name, DeviceRole role);

/// "name: description; name: ..." of the drivers for `role`, for help texts.
[[nodiscard]] std::string driver_list(DeviceRole role);

}  // namespace eti::devices
