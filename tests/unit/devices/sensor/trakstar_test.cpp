// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/vendor/trakstar.hpp"

#include <gmock/gmock.h>

#include "devices/sensor/device_error.hpp"
#include "tests/support/error_of.hpp"
#include "tests/unit/devices/sensor/stand_in/trakstar.hpp"
#include "vendor_fixture.hpp"

namespace eti::devices {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class TrakstarDriver : public ::testing::Test {
  protected:
    void SetUp() override {
        state_.plugged = true;
        state_.frozen = state_.not_finite = state_.left_handed = state_.other_hemisphere = false;
        state_.status = 0;
        state_.rate = 80.0;
        state_.shift_mm = 0.0;
        SensorSetup setup;
        setup.library = STAND_IN_TRAKSTAR;
        setup.source = "2";
        device_ = open_trakstar(setup);
        loop_ = std::make_unique<Loop>(*device_);
        ASSERT_TRUE(loop_->until([&] { return loop_->reading.motion.pose.translation.x() == 0.2f; }));
    }
    [[nodiscard]] float x() const { return loop_->reading.motion.pose.translation.x(); }

    stand_in::TrakstarState& state_ =
        stand_in_state<stand_in::TrakstarState>(STAND_IN_TRAKSTAR, "stand_in_trakstar");
    std::unique_ptr<Sensor> device_;
    std::unique_ptr<Loop> loop_;
};

TEST_F(TrakstarDriver, ReadsMillimetresAndTheSensorsAxes) {
    EXPECT_TRUE(state_.millimetres);
    EXPECT_EQ(state_.sensor, 2);
    EXPECT_LT((loop_->reading.motion.pose.translation - Vec3f(0.2f, 0.03f, 0.04f)).norm(), 1e-6f);
    // It rotates at +0.1 rad/s about z, from zero at the start of its clock.
    const Vec3f first = rotation_vector(loop_->reading.motion.pose.rotation);
    loop_->run_for(500ms);
    const Vec3f later = rotation_vector(loop_->reading.motion.pose.rotation);
    EXPECT_NEAR(later.z() - first.z(), 0.05f, 0.01f);
    EXPECT_NEAR(later.x(), 0.0f, 1e-5f);
    EXPECT_NEAR(loop_->reading.motion.angular_velocity.z(), 0.1f, 0.03f);
}

TEST_F(TrakstarDriver, ReconnectsAfterUnplugging) {
    const int opened = state_.opened;
    state_.plugged = false;
    ASSERT_TRUE(loop_->until([&] { return loop_->watch.health().lost; }));
    EXPECT_FALSE(loop_->reading.present);
    EXPECT_EQ(x(), 0.2f);
    ASSERT_TRUE(loop_->until([&] { return !device_->fault().empty(); }));
    EXPECT_THAT(device_->fault(), HasSubstr("cables"));
    state_.plugged = true;
    ASSERT_TRUE(loop_->until([&] { return loop_->reading.present; }));
    EXPECT_GT(state_.opened, opened);
    EXPECT_EQ(device_->fault(), "");
}

TEST_F(TrakstarDriver, AnUnpluggedSensorIsNamed) {
    state_.status = 0x2;
    ASSERT_TRUE(loop_->until([&] { return !device_->fault().empty(); }));
    EXPECT_THAT(device_->fault(), HasSubstr("sensor 2 is not plugged in"));
}

TEST_F(TrakstarDriver, OutOfRangeGivesNoMeasurement) {
    state_.status = 0x1000;
    EXPECT_TRUE(loop_->until([&] { return !loop_->reading.present; }));
    EXPECT_EQ(device_->fault(), "");
}

TEST_F(TrakstarDriver, AFrozenTrackerIsLost) {
    state_.frozen = true;
    EXPECT_TRUE(loop_->until([&] { return loop_->watch.health().lost; }));
}

TEST_F(TrakstarDriver, TenHertzIsReportedAsSlow) {
    state_.rate = 10.0;
    EXPECT_TRUE(loop_->until([&] { return loop_->watch.health().slow; }));
    EXPECT_FALSE(loop_->watch.health().lost);
    // The second in which it changed may contain some earlier samples.
    loop_->run_for(1100ms);
    EXPECT_NEAR(loop_->watch.health().rate, 10.0f, 2.5f);
}

TEST_F(TrakstarDriver, ImplausiblePosesAreRejected) {
    state_.shift_mm = 1000.0;
    loop_->run_for(100ms);
    EXPECT_EQ(x(), 0.2f);
    EXPECT_GT(loop_->watch.health().jumps, 0u);
    state_.shift_mm = 0.0;
    ASSERT_TRUE(loop_->until([&] { return loop_->reading.present; }));
    // A magnetic tracker may confuse hemispheres: every sign flips, and stays so for longer than a new
    // position takes to be accepted.
    state_.other_hemisphere = true;
    loop_->run_for(600ms);
    EXPECT_EQ(x(), 0.2f);
    EXPECT_TRUE(loop_->reading.present);
    state_.other_hemisphere = false;
    for (std::atomic<bool>* wrong : {&state_.not_finite, &state_.left_handed}) {
        const auto before = loop_->watch.health().not_finite;
        *wrong = true;
        ASSERT_TRUE(loop_->until([&] { return loop_->watch.health().not_finite > before; }));
        EXPECT_TRUE(loop_->reading.motion.pose.translation.allFinite());
        *wrong = false;
        ASSERT_TRUE(loop_->until([&] { return loop_->reading.present; }));
    }
}

TEST(TrakstarLibrary, MissingOrWrongLibraryNamesTheRemedy) {
    const auto refusal = [](const std::string& library, const std::string& source) -> std::string {
        SensorSetup setup;
        setup.library = library;
        setup.source = source;
        return test::error_of<DeviceError>([&] { (void)open_trakstar(setup); });
    };
    EXPECT_THAT(refusal("", ""), HasSubstr("3D Guidance API"));
    EXPECT_THAT(refusal(STAND_IN_OPENHAPTICS, ""), HasSubstr("InitializeBIRDSystem"));
    EXPECT_THAT(refusal(STAND_IN_TRAKSTAR, "first"), AllOf(HasSubstr("first"), HasSubstr("0 to 15")));
    auto& state = stand_in_state<stand_in::TrakstarState>(STAND_IN_TRAKSTAR, "stand_in_trakstar");
    state.plugged = false;
    EXPECT_THAT(refusal(STAND_IN_TRAKSTAR, "0"), HasSubstr("does not start"));
    state.plugged = true;
}

}  // namespace
}  // namespace eti::devices
