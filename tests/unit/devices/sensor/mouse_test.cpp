// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The window on a virtual display, driven by the events of a real X server.
#include "devices/sensor/input/mouse.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <string>

#include "close_window.hpp"
#include "common/device/held_tool.hpp"
#include "common/math/units.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/virtual_display.hpp"
#include "vendor_fixture.hpp"

namespace eti::devices {
namespace {

bool xdotool(const std::string& what) {
    return std::system(("xdotool " + what + " >/dev/null 2>&1").c_str()) == 0;
}

class MouseDriver : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!display_.ready() || !xdotool("version")) {
            GTEST_SKIP() << "needs Xvfb and xdotool";
        }
        device_ = open_mouse({});
        loop_ = std::make_unique<Loop>(*device_);
        loop_->run_for(200ms);
        ASSERT_TRUE(xdotool("mousemove 200 150"));
        loop_->run_for(200ms);
    }
    void TearDown() override {
        loop_.reset();
        device_.reset();
    }
    [[nodiscard]] Vec3f way() const {
        return loop_->reading.motion.pose.translation - parked_pose(Tool::laryngoscope).translation;
    }

    test::VirtualDisplay display_;
    std::unique_ptr<Sensor> device_;
    std::unique_ptr<Loop> loop_;
};

// 50 pixels to the right are 10 mm to the operator's right, the patient's right; up is anterior.
TEST_F(MouseDriver, DraggingMovesAndTurns) {
    EXPECT_TRUE(loop_->reading.present);
    EXPECT_LT(way().norm(), 1e-6f) << "moving the mouse alone moves nothing";
    ASSERT_TRUE(xdotool("mousedown 1 mousemove 250 120"));
    EXPECT_TRUE(loop_->until([&] { return (way() - Vec3f(-0.010f, -0.006f, 0)).norm() < 1e-5f; }, 3s))
        << way();
    ASSERT_TRUE(xdotool("mouseup 1 mousedown 3 mousemove 300 120"));
    EXPECT_TRUE(loop_->until(
        [&] {
            return (rotation_vector(loop_->reading.motion.pose.rotation) - Vec3f(0, -10.0f * degree, 0))
                       .norm() < 1e-5f;
        },
        3s));
    const RigidTransform before = loop_->reading.motion.pose;
    ASSERT_TRUE(xdotool("mouseup 3 click 4"));
    EXPECT_TRUE(loop_->until(
        [&] {
            const Vec3f slid = before.inverse() * loop_->reading.motion.pose.translation;
            return (slid - Vec3f(0, 0, 2e-3f)).norm() < 1e-5f;
        },
        3s))
        << "a notch forward slides the tool towards its tip";
}

TEST_F(MouseDriver, KeysMoveAndSpaceIsSuction) {
    ASSERT_TRUE(xdotool("keydown w keydown space"));
    EXPECT_TRUE(loop_->until([&] { return way().y() > 3e-3f && loop_->reading.buttons == 1u; }, 3s)) << way();
    ASSERT_TRUE(xdotool("keyup w keyup space"));
    EXPECT_TRUE(loop_->until([&] { return loop_->reading.buttons == 0u; }, 3s));
    const Vec3f stopped = way();
    loop_->run_for(200ms);
    EXPECT_LT((way() - stopped).norm(), 1e-3f);
}

TEST_F(MouseDriver, ClosedWindowIsALostDevice) {
    EXPECT_TRUE(loop_->reading.present);
    EXPECT_EQ(device_->fault(), "");
    ASSERT_TRUE(test::close_window("NeoETI hand"));
    ASSERT_TRUE(loop_->until([&] { return loop_->watch.health().lost; }, 3s));
    EXPECT_FALSE(loop_->reading.present);
    EXPECT_NE(device_->fault().find("start the program again"), std::string::npos) << device_->fault();
    EXPECT_LT(way().norm(), 1e-6f) << "it stays where it was";
}

// A pointer that jumps to the other side of the screen during a drag: 0.1 m in no time is no hand's motion.
TEST_F(MouseDriver, PointerJumpMovesAtHandSpeed) {
    ASSERT_TRUE(xdotool("mousemove 10 150 mousedown 1"));
    loop_->run_for(100ms);
    const Vec3f before = way();
    ASSERT_TRUE(xdotool("mousemove 510 150"));
    const Vec3f reach(-HandLimits().max_target_distance, 0.0f, 0.0f);
    EXPECT_TRUE(loop_->until([&] { return (way() - before - reach).norm() < 1e-5f; }, 3s)) << way();
    EXPECT_EQ(loop_->watch.health().jumps, 0u) << "the hand moves at most at 0.12 m/s";
    ASSERT_TRUE(xdotool("mouseup 1"));
}

TEST(Mouse, MissingDisplayErrorNamesTheVariable) {
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    EXPECT_THAT(test::error_of<DeviceError>([&] { (void)open_mouse({}); }), ::testing::HasSubstr("DISPLAY"));
}

}  // namespace
}  // namespace eti::devices
