// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/drivers.hpp"

#include <gmock/gmock.h>

#include "tests/support/error_of.hpp"

namespace eti::devices {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string driver_refusal(std::string_view name, DeviceRole role) {
    return test::error_of<DeviceError>([&] { (void)find_driver(name, role); });
}

TEST(Drivers, EveryDriverOpensOrExplainsItsFailure) {
    for (const Driver& driver : drivers()) {
        EXPECT_EQ(&find_driver(driver.name, driver.role), &driver);
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

TEST(Drivers, SimulatedHandsMoveWithoutAnySetup) {
    for (const char* name : {"simulated", "scripted"}) {
        const auto hand = find_driver(name, DeviceRole::tool).open({});
        ASSERT_NE(hand, nullptr) << name;
        Observation seen;
        seen.landmarks.fill(Vec3f::Zero());
        seen.landmarks[static_cast<std::size_t>(Landmark::upper_gum)] = Vec3f(0.0f, 0.014f, 0.022f);
        seen.landmarks[static_cast<std::size_t>(Landmark::glottis)] = Vec3f(0.0f, 0.040f, -0.031f);
        hand->observe(seen);
        const Reading first = hand->exchange({}, 1e-3f);
        Reading last = first;
        for (int cycle = 0; cycle < 2000; ++cycle) {
            last = hand->exchange({}, 1e-3f);
            ASSERT_TRUE(is_motion(last.motion)) << name << ", cycle " << cycle;
        }
        EXPECT_TRUE(last.present) << name;
        EXPECT_GT(last.sample, first.sample) << name;
    }
}

TEST(Drivers, UnknownNameListsTheDrivers) {
    EXPECT_THAT(driver_refusal("touch", DeviceRole::tool),
                AllOf(HasSubstr("touch"), HasSubstr("openhaptics")));
    EXPECT_THAT(driver_refusal("", DeviceRole::commands), AllOf(HasSubstr("gamepad"), HasSubstr("keyboard")));
}

TEST(Drivers, DeviceOfAnotherRoleIsNotOffered) {
    EXPECT_THAT(driver_refusal("gamepad", DeviceRole::tool),
                AllOf(HasSubstr("available: simulated"), Not(HasSubstr("keyboard"))));
    EXPECT_THAT(driver_refusal("simulated", DeviceRole::commands), HasSubstr("available: gamepad, keyboard"));
    EXPECT_THAT(driver_list(DeviceRole::tool), AllOf(HasSubstr("trakstar: "), Not(HasSubstr("keyboard: "))));
}

}  // namespace
}  // namespace eti::devices
