// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/drivers.hpp"

#include <array>
#include <string>

#include "devices/sensor/hand_sensor.hpp"
#include "devices/sensor/input/gamepad.hpp"
#include "devices/sensor/input/keyboard.hpp"
#include "devices/sensor/input/mouse.hpp"
#include "devices/sensor/recorded.hpp"
#include "devices/sensor/vendor/openhaptics.hpp"
#include "devices/sensor/vendor/spacenav.hpp"
#include "devices/sensor/vendor/trakstar.hpp"

namespace eti::devices {

namespace {

std::unique_ptr<Sensor> open_hand(const SensorSetup& setup) {
    return std::make_unique<HandSensor>(setup);
}

constexpr std::array<Driver, 9> table = {{
    {"simulated", DeviceRole::tool, false, "haptic arm and the hand that holds it, both simulated",
     &open_hand},
    {"scripted", DeviceRole::tool, false, "tracked tool in a simulated hand", &open_hand},
    {"recorded", DeviceRole::tool, false, "hand recorded in the session file --source", &open_recorded},
    {"mouse", DeviceRole::tool, false, "mouse and keys, in a window of its own", &open_mouse},
    {"spacenav", DeviceRole::tool, false, "6-DOF mouse through spacenavd", &open_spacenav},
    {"openhaptics", DeviceRole::tool, true, "Touch or Touch X through OpenHaptics; --source: its name there",
     &open_openhaptics},
    {"trakstar", DeviceRole::tool, true, "Ascension 3D Guidance tracker; --source: the sensor's number",
     &open_trakstar},
    {"gamepad", DeviceRole::commands, false, "pad; --source: its file (default /dev/input/js0)",
     &open_gamepad},
    {"keyboard", DeviceRole::commands, false, "keyboard of this terminal", &open_keyboard},
}};

}  // namespace

std::span<const Driver> drivers() {
    return table;
}

const Driver& find_driver(std::string_view name, DeviceRole role) {
    std::string known;
    for (const Driver& driver : table) {
        if (driver.role != role) {
            continue;
        }
        if (driver.name == name) {
            return driver;
        }
        known += (known.empty() ? "" : ", ") + std::string(driver.name);
    }
    throw DeviceError("--device " + std::string(name) + ": no such device; available: " + known);
}

std::string driver_list(DeviceRole role) {
    std::string list;
    for (const Driver& driver : table) {
        if (driver.role == role) {
            list += (list.empty() ? "" : "; ") + std::string(driver.name) + ": " +
                    std::string(driver.description);
        }
    }
    return list;
}

}  // namespace eti::devices
