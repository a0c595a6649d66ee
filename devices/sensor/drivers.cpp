// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/drivers.hpp"

#include <array>
#include <string>

#include "devices/sensor/hand_sensor.hpp"

namespace eti::devices {

namespace {

std::unique_ptr<Sensor> open_hand(const SensorSetup& setup) {
    return std::make_unique<HandSensor>(setup);
}

constexpr std::array<Driver, 2> table = {{
    {"simulated", Tool::laryngoscope, "haptic arm and the hand that holds it, both simulated", &open_hand},
    {"scripted", Tool::tube, "tracked tube in a simulated hand", &open_hand},
}};

}  // namespace

std::span<const Driver> drivers() {
    return table;
}

const Driver& driver_named(std::string_view name, Tool tool) {
    std::string known;
    for (const Driver& driver : table) {
        if (driver.tool != tool) {
            continue;
        }
        if (driver.name == name) {
            return driver;
        }
        known += (known.empty() ? "" : ", ") + std::string(driver.name);
    }
    throw DeviceError("--device " + std::string(name) + ": no such device; there is: " + known);
}

}  // namespace eti::devices
