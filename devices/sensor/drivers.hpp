// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "common/model/parked_pose.hpp"
#include "devices/sensor/device_error.hpp"
#include "devices/sensor/sensor.hpp"

namespace eti::devices {

/// What a driver needs to open its device.
struct SensorSetup {
    Tool tool = Tool::laryngoscope;
    std::optional<OperatorScript> script;  ///< for scripted hands; without it they hold still
    float tool_length = 0.1f;              ///< [m], from the tool frame's origin to its tip
    float curvature = 0.0f;                ///< [1/m], of a tube; see TrackPlayer
    Observation start;                     ///< what the scripted hand sees first
    std::string source{};                  ///< file, name or number of the device; empty: the usual one
    std::string library{};                 ///< the vendor's library by path; empty: by its usual names
};

/// What a device is for: some hold a tool, some give commands.
enum class Use : std::uint8_t { tool, commands };

/// A row of the table of drivers; a new device is a new row.
struct Driver {
    std::string_view name;
    Use use;
    bool needs_calibration;  ///< its poses are in a frame of its own; see eti-calibrate
    std::string_view description;
    std::unique_ptr<Sensor> (*open)(const SensorSetup& setup);
};

[[nodiscard]] std::span<const Driver> drivers();

/// The driver of that name for `use`. Throws DeviceError naming those there are.
[[nodiscard]] const Driver& driver_named(std::string_view name, Use use);

/// "name: description; name: ..." of the drivers for `use`, for help texts.
[[nodiscard]] std::string driver_list(Use use);

}  // namespace eti::devices
