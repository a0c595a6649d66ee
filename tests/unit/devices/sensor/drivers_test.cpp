// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/drivers.hpp"

#include <gmock/gmock.h>

namespace eti::devices {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string driver_refusal(std::string_view name, Use use) {
    try {
        (void)driver_named(name, use);
    } catch (const DeviceError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Drivers, EveryRowOpensOrSaysWhatItLacks) {
    for (const Driver& driver : drivers()) {
        EXPECT_EQ(&driver_named(driver.name, driver.use), &driver);
        SensorSetup setup;
        setup.library = driver.name == "simulated" || driver.name == "scripted" ? "" : "/nowhere/lib.so";
        setup.source = driver.name == "gamepad" ? "/nowhere/js0" : "";
        try {
            EXPECT_NE(driver.open(setup), nullptr) << driver.name;
        } catch (const DeviceError& error) {
            EXPECT_GT(std::string_view(error.what()).size(), 20u) << driver.name;
        }
    }
}

TEST(Drivers, SimulatedHandsNeedNothing) {
    for (const char* name : {"simulated", "scripted"}) {
        EXPECT_NE(driver_named(name, Use::tool).open({}), nullptr);
    }
}

TEST(Drivers, AnUnknownNameIsRefusedWithThoseThereAre) {
    EXPECT_THAT(driver_refusal("touch", Use::tool), AllOf(HasSubstr("touch"), HasSubstr("openhaptics")));
    EXPECT_THAT(driver_refusal("", Use::commands), AllOf(HasSubstr("gamepad"), HasSubstr("keyboard")));
}

TEST(Drivers, ADeviceOfAnotherUseIsNotOffered) {
    EXPECT_THAT(driver_refusal("gamepad", Use::tool),
                AllOf(HasSubstr("there is: simulated"), Not(HasSubstr("keyboard"))));
    EXPECT_THAT(driver_refusal("simulated", Use::commands), HasSubstr("there is: gamepad, keyboard"));
    EXPECT_THAT(driver_list(Use::tool), AllOf(HasSubstr("trakstar: "), Not(HasSubstr("keyboard: "))));
}

}  // namespace
}  // namespace eti::devices
