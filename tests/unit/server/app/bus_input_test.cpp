// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/bus_input.hpp"

#include <gtest/gtest.h>

#include "common/bus/codec/convert.hpp"
#include "tests/unit/common/bus/bus_fixture.hpp"

namespace eti::app {
namespace {

using namespace std::chrono_literals;
using bus::eventually;

msg::ToolPose pose_at(float x, std::uint32_t buttons = 0) {
    msg::ToolPose message;
    RigidTransform pose;
    pose.translation = {x, 0.0f, 0.0f};
    message.pose(bus::to_msg(pose));
    message.buttons(buttons);
    return message;
}

class BusInputTest : public testing::Test {
  protected:
    /// Sends until the server has received it.
    bool heard(bus::Publisher<msg::ToolPose>& from, float x) {
        return eventually([&] {
            from.publish(pose_at(x, 1));
            input_.poll();
            return input_.laryngoscope().pose() && input_.laryngoscope().pose()->translation.x() == x &&
                   input_.laryngoscope().presence() == msg::DEVICE_HEARD;
        });
    }

    bus::Node server_{bus::options("eti-server")};
    BusInput input_{server_};
};

TEST_F(BusInputTest, StoppedDeviceTurnsSilentAndKeepsPose) {
    bus::Node hand(bus::options("hand"));
    bus::Publisher<msg::ToolPose> poses(hand, bus::topics::laryngoscope_pose);
    EXPECT_EQ(input_.laryngoscope().presence(), msg::DEVICE_NONE);
    ASSERT_TRUE(heard(poses, 0.1f));
    EXPECT_TRUE(input_.suction());
    EXPECT_EQ(input_.tube().presence(), msg::DEVICE_NONE) << "nobody was there";
    const auto start = bus::Clock::now();
    ASSERT_TRUE(eventually([&] {
        input_.poll();
        return input_.laryngoscope().presence() == msg::DEVICE_SILENT;
    }));
    EXPECT_GE(bus::Clock::now() - start, 450ms);
    EXPECT_EQ(input_.laryngoscope().pose()->translation.x(), 0.1f);
    EXPECT_FALSE(input_.suction()) << "nobody holds the button";
    EXPECT_TRUE(heard(poses, 0.2f)) << "it is back";
}

TEST_F(BusInputTest, SecondDeviceTakesOverFromSilentFirst) {
    bus::Node first(bus::options("first")), second(bus::options("second"));
    bus::Publisher<msg::ToolPose> one(first, bus::topics::laryngoscope_pose);
    ASSERT_TRUE(heard(one, 0.1f));
    bus::Publisher<msg::ToolPose> two(second, bus::topics::laryngoscope_pose);
    for (int i = 0; i < 50; ++i) {
        one.publish(pose_at(0.1f));
        two.publish(pose_at(0.5f));
        std::this_thread::sleep_for(10ms);
        input_.poll();
        ASSERT_EQ(input_.laryngoscope().pose()->translation.x(), 0.1f);
    }
    EXPECT_TRUE(heard(two, 0.5f));
    // The first gets its tool back, although the second sends on.
    const auto first_returns = [&] {
        one.publish(pose_at(0.1f));
        two.publish(pose_at(0.5f));
        std::this_thread::sleep_for(10ms);
        input_.poll();
        return input_.laryngoscope().pose()->translation.x() == 0.1f;
    };
    ASSERT_TRUE(eventually(first_returns));
    for (int i = 0; i < 50; ++i) {
        ASSERT_TRUE(first_returns());
    }
}

TEST_F(BusInputTest, ImplausiblePosesAreRefused) {
    bus::Node hand(bus::options("hand"));
    bus::Publisher<msg::ToolPose> poses(hand, bus::topics::tube_pose);
    ASSERT_TRUE(eventually([&] {
        poses.publish(pose_at(std::numeric_limits<float>::quiet_NaN()));
        input_.poll();
        return input_.refused() > 0;
    }));
    const std::uint64_t before = input_.refused();
    ASSERT_TRUE(eventually([&] {
        poses.publish(pose_at(2.5f));
        input_.poll();
        return input_.refused() > before;
    }));
    EXPECT_FALSE(input_.tube().pose());
}

TEST_F(BusInputTest, AnnotationsAreRateLimitedPerSender) {
    bus::Node teacher(bus::options("teacher"));
    bus::Publisher<msg::Annotation> notes(teacher, bus::topics::annotation);
    ASSERT_TRUE(eventually([&] { return notes.matched() == 1; }));
    std::size_t taken = 0;
    for (int i = 0; i < 60; ++i) {
        msg::Annotation note;
        note.sender("teacher");
        note.text("remark");
        ASSERT_TRUE(notes.publish(note));
        ASSERT_TRUE(notes.wait_until_received(5s));
        input_.poll();
        taken += input_.take_annotations().size();
    }
    EXPECT_GE(taken, 20u);
    EXPECT_LT(taken, 60u);
}

}  // namespace
}  // namespace eti::app
