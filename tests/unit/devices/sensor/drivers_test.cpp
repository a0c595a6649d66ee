// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/drivers.hpp"

#include <gmock/gmock.h>

namespace eti::devices {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string refusal(std::string_view name, Tool tool) {
    try {
        (void)driver_named(name, tool);
    } catch (const DeviceError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Drivers, EveryRowOpensByItsName) {
    for (const Driver& driver : drivers()) {
        EXPECT_EQ(&driver_named(driver.name, driver.tool), &driver);
        const auto sensor =
            driver.open({.tool = driver.tool, .script = {}, .tool_length = 0.1f, .start = {}});
        EXPECT_NE(sensor, nullptr) << driver.name;
    }
}

TEST(Drivers, AnUnknownNameIsRefusedWithThoseThereAre) {
    EXPECT_THAT(refusal("touch", Tool::laryngoscope), AllOf(HasSubstr("touch"), HasSubstr("simulated")));
    EXPECT_THAT(refusal("", Tool::tube), HasSubstr("scripted"));
}

TEST(Drivers, ADeviceOfTheOtherToolIsNotOffered) {
    EXPECT_THAT(refusal("scripted", Tool::laryngoscope),
                AllOf(HasSubstr("there is: simulated"), Not(HasSubstr("accepted"))));
    EXPECT_THAT(refusal("simulated", Tool::tube), HasSubstr("there is: scripted"));
}

}  // namespace
}  // namespace eti::devices
