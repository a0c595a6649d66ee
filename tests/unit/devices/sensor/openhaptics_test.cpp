// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/vendor/openhaptics.hpp"

#include <gmock/gmock.h>

#include "devices/sensor/device_error.hpp"
#include "tests/support/error_of.hpp"
#include "tests/unit/devices/sensor/stand_in/openhaptics.hpp"
#include "vendor_fixture.hpp"

namespace eti::devices {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string openhaptics_refusal(const SensorSetup& setup) {
    return test::error_of<DeviceError>([&] { (void)open_openhaptics(setup); });
}

/// The cycle of a haptic loop: exchanges through a monitor, in the calling thread.
class Cycle final : public ServoCycle {
  public:
    explicit Cycle(Sensor& device) : watch(device, limits()) {}
    static SensorMonitorLimits limits() {
        SensorMonitorLimits limits;
        limits.frozen_after = 0.3f;  // so that the test does not wait for 5 s
        return limits;
    }
    void servo_cycle() noexcept override {
        const Wrench wrench{{pull.load(), 0.0f, 0.0f}, Vec3f::Zero()};
        const auto now = std::chrono::steady_clock::now();
        const Reading reading = watch.exchange(wrench, std::chrono::duration<float>(now - last_).count());
        last_ = now;
        present = reading.present;
        x = reading.motion.pose.translation.x();
        y = reading.motion.pose.translation.y();
        finite = finite && reading.motion.pose.translation.allFinite();
        buttons = reading.buttons;
        thread = std::this_thread::get_id();
        ++cycles;
    }
    SensorMonitor watch;
    std::atomic<float> pull{0.0f}, x{0.0f}, y{0.0f};
    std::atomic<bool> present{false}, finite{true};
    std::atomic<std::uint32_t> buttons{0};
    std::atomic<std::thread::id> thread;
    std::atomic<int> cycles{0};

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

class OpenHapticsDriver : public ::testing::Test {
  protected:
    void SetUp() override {
        state_.plugged = state_.servo_calls = true;
        state_.servo_period_us = 1000;
        state_.not_finite = state_.left_handed = state_.frozen = false;
        state_.shift_mm = 0.0;
        setup_.library = STAND_IN_OPENHAPTICS;
        device_ = open_openhaptics(setup_);
        cycle_ = std::make_unique<Cycle>(*device_);
        ASSERT_TRUE(device_->start_servo(*cycle_));
        ASSERT_TRUE(eventually([&] { return cycle_->present.load(); }));
    }
    void TearDown() override { device_->stop_servo(); }

    bool tended_until(auto condition) {
        return eventually([&] {
            device_->poll_events();
            return condition();
        });
    }

    stand_in::OpenHapticsState& state_ =
        stand_in_state<stand_in::OpenHapticsState>(STAND_IN_OPENHAPTICS, "stand_in_openhaptics");
    SensorSetup setup_;
    std::unique_ptr<Sensor> device_;
    std::unique_ptr<Cycle> cycle_;
};

TEST_F(OpenHapticsDriver, RunsCycleInVendorThreadInMetres) {
    EXPECT_NE(cycle_->thread.load(), std::this_thread::get_id());
    EXPECT_NEAR(cycle_->x, 0.01f, 1e-3f);
    EXPECT_NEAR(cycle_->y, 0.02f, 1e-3f);
    EXPECT_FLOAT_EQ(device_->capabilities().force, 3.3f);
    EXPECT_EQ(device_->capabilities().torque, 0.0f) << "a device of three motors";
    state_.buttons = 2;
    EXPECT_TRUE(eventually([&] { return cycle_->buttons == 2u; }));
    state_.buttons = 0;
}

TEST_F(OpenHapticsDriver, ForceMovesTheSimulatedHand) {
    cycle_->pull = 2.0f;
    EXPECT_TRUE(eventually([&] { return state_.force[0] == 2.0; }));
    // 2 N against 900 N/m: 2.2 mm.
    EXPECT_TRUE(eventually([&] { return cycle_->x > 0.0119f && cycle_->x < 0.0125f; })) << cycle_->x;
}

TEST_F(OpenHapticsDriver, ReconnectsAfterUnplugging) {
    const int opened = state_.opened;
    state_.plugged = false;
    ASSERT_TRUE(tended_until([&] { return cycle_->watch.health().lost && !device_->fault().empty(); }));
    EXPECT_FALSE(cycle_->present);
    EXPECT_THAT(device_->fault(), AllOf(HasSubstr("communication error"), HasSubstr("cable")));
    state_.plugged = true;
    ASSERT_TRUE(tended_until([&] { return cycle_->present.load(); }));
    EXPECT_GT(state_.opened, opened);
    EXPECT_EQ(device_->fault(), "");
    EXPECT_TRUE(state_.forces_on) << "motors are switched on again";
}

TEST_F(OpenHapticsDriver, StalledServoThreadIsDetected) {
    state_.servo_calls = false;
    ASSERT_TRUE(tended_until([&] { return !device_->fault().empty() || state_.opened > 1; }));
    state_.servo_calls = true;
    const int before = cycle_->cycles;
    EXPECT_TRUE(tended_until([&] { return cycle_->cycles > before + 10; }));
}

TEST_F(OpenHapticsDriver, FrozenPoseIsDetectedUnderForce) {
    state_.frozen = true;
    const int before = cycle_->cycles;
    ASSERT_TRUE(eventually([&] { return cycle_->cycles > before + 600; }));
    EXPECT_TRUE(cycle_->present) << "at rest";
    cycle_->pull = 1.0f;
    EXPECT_TRUE(eventually([&] { return !cycle_->present; }));
    EXPECT_TRUE(cycle_->watch.health().frozen);
    cycle_->pull = 0.0f;
    state_.frozen = false;
    EXPECT_TRUE(eventually([&] { return cycle_->present.load(); }));
    EXPECT_FALSE(cycle_->watch.health().lost);
}

TEST_F(OpenHapticsDriver, TenHertzIsReportedAsSlow) {
    state_.servo_period_us = 100'000;
    EXPECT_TRUE(tended_until([&] { return cycle_->watch.health().slow; }));
    EXPECT_FALSE(cycle_->watch.health().lost);
    EXPECT_EQ(device_->fault(), "");
}

TEST_F(OpenHapticsDriver, ImplausiblePosesAreRejected) {
    state_.shift_mm = 1000.0;
    std::this_thread::sleep_for(50ms);
    EXPECT_LT(cycle_->x, 0.1f);
    state_.shift_mm = 0.0;
    ASSERT_TRUE(eventually([&] { return cycle_->present.load(); }));
    for (std::atomic<bool>* wrong : {&state_.not_finite, &state_.left_handed}) {
        const auto before = cycle_->watch.health().not_finite;
        *wrong = true;
        EXPECT_TRUE(eventually([&] { return !cycle_->present; }));
        EXPECT_GT(cycle_->watch.health().not_finite, before);
        *wrong = false;
        EXPECT_TRUE(eventually([&] { return cycle_->present.load(); }));
    }
    EXPECT_TRUE(cycle_->finite);
    EXPECT_GT(cycle_->watch.health().jumps, 0u);
}

TEST(OpenHapticsLibrary, MissingLibraryNamesWhatToInstall) {
    SensorSetup setup;
    setup.library = "/nowhere/libHD.so";
    EXPECT_THAT(openhaptics_refusal(setup),
                AllOf(HasSubstr("/nowhere/libHD.so"), HasSubstr("Install OpenHaptics")));
    setup.library.clear();
    EXPECT_THAT(openhaptics_refusal(setup), HasSubstr("Install OpenHaptics"));
}

TEST(OpenHapticsLibrary, WrongLibraryIsRefusedByName) {
    SensorSetup setup;
    setup.library = STAND_IN_TRAKSTAR;
    EXPECT_THAT(openhaptics_refusal(setup), AllOf(HasSubstr("hdInitDevice"), HasSubstr("another library")));
}

TEST(OpenHapticsLibrary, UnresponsiveDeviceReportsTheVendorError) {
    SensorSetup setup;
    setup.library = STAND_IN_OPENHAPTICS;
    setup.source = "nobody";
    EXPECT_THAT(openhaptics_refusal(setup), AllOf(HasSubstr("'nobody'"), HasSubstr("communication error")));
}

}  // namespace
}  // namespace eti::devices
