// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/sensor/vendor/spacenav.hpp"

#include <gmock/gmock.h>
#include <spnav.h>

#include "common/math/units.hpp"
#include "devices/sensor/device_error.hpp"
#include "tests/support/error_of.hpp"
#include "tests/unit/devices/sensor/stand_in/spacenav.hpp"
#include "vendor_fixture.hpp"

namespace eti::devices {
namespace {

using ::testing::HasSubstr;

class SpacenavDriver : public ::testing::Test {
  protected:
    void SetUp() override {
        state_.daemon = true;
        SensorSetup setup;
        setup.library = STAND_IN_SPACENAV;
        device_ = open_spacenav(setup);
        loop_ = std::make_unique<Loop>(*device_);
        (void)loop_->once();
    }
    bool send(int type, const int (&values)[6], unsigned int period = 10) {
        return state_.send(type, values, period);
    }
    [[nodiscard]] Vec3f way() const {
        return loop_->reading.motion.pose.translation - parked_pose(Tool::laryngoscope).translation;
    }

    stand_in::SpacenavState& state_ =
        stand_in_state<stand_in::SpacenavState>(STAND_IN_SPACENAV, "stand_in_spacenav");
    std::unique_ptr<Sensor> device_;
    std::unique_ptr<Loop> loop_;
};

// Fully pushed for ten events of 10 ms: 10 cm/s * 0.1 s = 1 cm; the operator's right is the patient's right,
// up is anterior, away from the body is towards the feet.
TEST_F(SpacenavDriver, PushSetsVelocityInOperatorFrame) {
    for (int i = 0; i < 10; ++i) {
        ASSERT_TRUE(send(1, {350, 0, 0, 0, 0, 0}));
    }
    EXPECT_TRUE(loop_->until([&] { return (way() - Vec3f(-0.01f, 0, 0)).norm() < 1e-5f; })) << way();
    for (int i = 0; i < 10; ++i) {
        ASSERT_TRUE(send(1, {0, 350, 350, 0, 0, 0}));
    }
    EXPECT_TRUE(loop_->until([&] { return (way() - Vec3f(-0.01f, -0.01f, -0.01f)).norm() < 1e-5f; }))
        << way();
    for (int i = 0; i < 10; ++i) {
        ASSERT_TRUE(send(1, {0, 0, 0, 0, 350, 0}));
    }
    // 60 deg/s * 0.1 s about the operator's vertical, which is the patient's -y.
    EXPECT_TRUE(loop_->until([&] {
        return (rotation_vector(loop_->reading.motion.pose.rotation) - Vec3f(0, -6.0f * degree, 0)).norm() <
               1e-4f;
    }));
    EXPECT_TRUE(loop_->reading.present);
}

TEST_F(SpacenavDriver, EventMotionIsLimitedToHandSpeed) {
    ASSERT_TRUE(send(1, {2'000'000'000, 0, 0, -2'000'000'000, 0, 0}, 4'000'000'000u));
    loop_->run_for(100ms);
    EXPECT_LE(way().norm(), 0.10f * 0.05f + 1e-6f);
    EXPECT_TRUE(loop_->reading.motion.pose.translation.allFinite());
}

TEST_F(SpacenavDriver, ButtonsAreBits) {
    ASSERT_TRUE(send(2, {1, 0, 0, 0, 0, 0}));
    EXPECT_TRUE(loop_->until([&] { return loop_->reading.buttons == 1u; }));
    ASSERT_TRUE(send(2, {0, 0, 0, 0, 0, 0}));
    EXPECT_TRUE(loop_->until([&] { return loop_->reading.buttons == 0u; }));
}

TEST_F(SpacenavDriver, ReconnectsAfterDaemonDeath) {
    state_.hang_up();
    ASSERT_TRUE(loop_->until([&] { return loop_->watch.health().lost && !device_->fault().empty(); }));
    EXPECT_THAT(device_->fault(), HasSubstr("systemctl start spacenavd"));
    state_.daemon = true;
    EXPECT_TRUE(loop_->until([&] { return loop_->reading.present; }));
    EXPECT_EQ(device_->fault(), "");
}

TEST_F(SpacenavDriver, ReconnectsAfterUnplugging) {
    ASSERT_TRUE(send(SPNAV_EVENT_DEV, {SPNAV_DEV_RM, 0, 0, 0, 0, 0}));
    ASSERT_TRUE(loop_->until([&] { return loop_->watch.health().lost && !device_->fault().empty(); }));
    EXPECT_THAT(device_->fault(), HasSubstr("unplugged"));
    EXPECT_TRUE(loop_->until([&] { return loop_->reading.present; }));
}

TEST(SpacenavLibrary, MissingDaemonErrorNamesIt) {
    auto& state = stand_in_state<stand_in::SpacenavState>(STAND_IN_SPACENAV, "stand_in_spacenav");
    state.daemon = false;
    SensorSetup setup;
    setup.library = STAND_IN_SPACENAV;
    EXPECT_THAT(test::error_of<DeviceError>([&] { (void)open_spacenav(setup); }),
                HasSubstr("spacenavd is not running"));
    state.daemon = true;
}

// Debian's own library, which the driver loads by default.
TEST(SpacenavLibrary, DebianLibraryHasTheEntryPoints) {
    try {
        (void)open_spacenav({});
    } catch (const DeviceError& error) {
        EXPECT_THAT(error.what(), HasSubstr("spacenavd is not running"));
    }
}

}  // namespace
}  // namespace eti::devices
