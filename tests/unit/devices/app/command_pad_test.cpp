// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/app/command_pad.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/math/units.hpp"

namespace eti::devices {
namespace {

constexpr float dt = 0.02f;

RuntimeParameters posture(float head_deg, float jaw_deg, float table_deg) {
    return {.head_elevation = head_deg * degree,
            .jaw_opening = jaw_deg * degree,
            .table_angle = table_deg * degree};
}

/// A pad that has received a patient's posture.
CommandPad pad_at(float head_deg, float jaw_deg, float table_deg) {
    CommandPad pad;
    pad.follow(posture(head_deg, jaw_deg, table_deg));
    return pad;
}

TEST(CommandPad, AStickMovesAPostureAtTenDegreesASecond) {
    CommandPad pad = pad_at(10.0f, 20.0f, 0.0f);
    Reading reading;
    EXPECT_TRUE(pad.update(reading, dt).empty()) << "a stick that rests sends nothing";
    reading.axes[1] = -1.0f;  // away from the body
    std::vector<PadCommand> sent;
    for (int i = 0; i < 50; ++i) {
        for (const PadCommand& command : pad.update(reading, dt)) {
            sent.push_back(command);
        }
    }
    ASSERT_FALSE(sent.empty());
    // A second of it, one command per half degree.
    EXPECT_LE(sent.size(), 20u);
    EXPECT_GE(sent.size(), 15u);
    EXPECT_EQ(sent.back().name, "head_elevation");
    reading.axes[1] = 0.0f;
    for (const PadCommand& command : pad.update(reading, dt)) {
        sent.push_back(command);
    }
    EXPECT_NEAR(sent.back().value, 20.0f * degree, 1e-4f) << "what was left comes when the stick rests";
    EXPECT_TRUE(pad.update(reading, dt).empty());
}

TEST(CommandPad, SuctionIsResentToNewServerAndEndsWithPad) {
    CommandPad pad;
    EXPECT_TRUE(pad.release().empty());
    Reading reading;
    reading.buttons = 1;
    EXPECT_EQ(pad.update(reading, dt).size(), 1u);
    EXPECT_TRUE(pad.update(reading, dt).empty());
    pad.resend_held_inputs();
    ASSERT_EQ(pad.update(reading, dt).size(), 1u);
    const std::vector<PadCommand> last = pad.release();
    ASSERT_EQ(last.size(), 1u);
    EXPECT_EQ(last[0].name, "suction");
    EXPECT_EQ(last[0].value, 0.0f);
    EXPECT_TRUE(pad.release().empty());
}

TEST(CommandPad, MovesNothingUntilPostureIsKnown) {
    CommandPad pad;
    Reading reading;
    reading.axes[1] = -1.0f;
    for (int i = 0; i < 50; ++i) {
        EXPECT_TRUE(pad.update(reading, dt).empty());
    }
    pad.follow(posture(std::numeric_limits<float>::quiet_NaN(), 20.0f, 0.0f));
    EXPECT_TRUE(pad.update(reading, 0.1f).empty()) << "a posture that is no number is none";
}

TEST(CommandPad, ContinuesFromTheServersPosture) {
    CommandPad pad = pad_at(26.0f, 29.0f, 0.0f);
    pad.follow(posture(5.0f, 29.0f, 0.0f));  // the instructor has lowered the head meanwhile
    Reading reading;
    reading.axes[1] = -1.0f;
    std::vector<PadCommand> sent = pad.update(reading, 0.1f);
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_NEAR(sent[0].value, 6.0f * degree, 1e-5f);
    // The patient lags behind the stick; postures it reports meanwhile are ignored.
    pad.follow(posture(5.2f, 29.0f, 0.0f));
    sent = pad.update(reading, 0.1f);
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_NEAR(sent[0].value, 7.0f * degree, 1e-5f);
    reading.axes = {};
    for (int i = 0; i < 51; ++i) {
        EXPECT_TRUE(pad.update(reading, dt).empty());
    }
    pad.follow(posture(20.0f, 29.0f, 0.0f));
    EXPECT_TRUE(pad.update(reading, dt).empty()) << "what the server tells is not sent back";
    reading.axes[1] = 1.0f;
    sent = pad.update(reading, 0.1f);
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_NEAR(sent[0].value, 19.0f * degree, 1e-5f);
}

TEST(CommandPad, PosturesStayWithinTheServersBounds) {
    CommandPad pad = pad_at(10.0f, 20.0f, 0.0f);
    Reading reading;
    reading.axes[0] = 1.0f;
    reading.axes[1] = 1.0f;
    float jaw = 0.0f, head = 1.0f;
    for (int i = 0; i < 500; ++i) {
        for (const PadCommand& command : pad.update(reading, dt)) {
            (command.name == "jaw_opening" ? jaw : head) = command.value;
        }
    }
    reading.axes = {};
    for (const PadCommand& command : pad.update(reading, dt)) {
        (command.name == "jaw_opening" ? jaw : head) = command.value;
    }
    EXPECT_NEAR(jaw, 35.0f * degree, 1e-5f);
    EXPECT_NEAR(head, 0.0f, 1e-6f);
}

TEST(CommandPad, TheRightStickTiltsTheTableEitherWay) {
    CommandPad pad = pad_at(0.0f, 0.0f, 15.0f);
    Reading reading;
    for (const float stick : {-1.0f, 1.0f}) {
        reading.axes[4] = stick;
        float table = 0.0f;
        for (int i = 0; i < 500; ++i) {
            for (const PadCommand& command : pad.update(reading, dt)) {
                EXPECT_EQ(command.name, "table_angle");
                table = command.value;
            }
        }
        reading.axes = {};
        for (const PadCommand& command : pad.update(reading, dt)) {
            table = command.value;
        }
        EXPECT_NEAR(table, -20.0f * degree * stick, 1e-5f) << "away from the body is head-up";
    }
}

TEST(CommandPad, PressesTheLarynxAndEndsWithThePad) {
    struct Push {
        std::size_t axis;
        float stick;
        const char* name;
        float force;  // [N], after half a second
    };
    for (const Push& push :
         {Push{3, 1.0f, "laryngeal_pressure_back", 1.5f}, Push{6, -1.0f, "laryngeal_pressure_right", -1.5f},
          Push{7, -1.0f, "laryngeal_pressure_up", 1.5f}}) {
        CommandPad pad = pad_at(10.0f, 20.0f, 0.0f);
        Reading reading;
        reading.axes[push.axis] = push.stick;
        std::vector<PadCommand> sent;
        for (int i = 0; i < 26; ++i) {
            if (i == 25) {
                reading.axes = {};
            }
            for (const PadCommand& command : pad.update(reading, dt)) {
                sent.push_back(command);
            }
        }
        ASSERT_FALSE(sent.empty()) << push.name;
        EXPECT_LE(sent.size(), 7u) << "one a quarter of a newton";
        EXPECT_EQ(sent.back().name, push.name);
        EXPECT_NEAR(sent.back().value, push.force, 1e-4f) << push.name;
        reading.present = false;
        const std::vector<PadCommand> last = pad.update(reading, dt);
        ASSERT_EQ(last.size(), 1u) << push.name;
        EXPECT_EQ(last[0].name, push.name);
        EXPECT_EQ(last[0].value, 0.0f);
        EXPECT_TRUE(pad.release().empty());
    }
}

TEST(CommandPad, LeavesThePressureOfOthers) {
    CommandPad pad;
    RuntimeParameters pressed;
    pressed.laryngeal_pressure_back = 4.0f;
    pad.follow(pressed);
    EXPECT_TRUE(pad.release().empty());
}

TEST(CommandPad, ButtonAndTriggerControlSuction) {
    CommandPad pad;
    Reading reading;
    reading.buttons = 1;
    auto sent = pad.update(reading, dt);
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].name, "suction");
    EXPECT_EQ(sent[0].value, 1.0f);
    EXPECT_TRUE(pad.update(reading, dt).empty());
    reading.buttons = 0;
    EXPECT_EQ(pad.update(reading, dt)[0].value, 0.0f);
    // An axis that was never at its end is no trigger: a pad without triggers reports 0 there.
    reading.axes[5] = 0.0f;
    EXPECT_TRUE(pad.update(reading, dt).empty());
    reading.axes[5] = -1.0f;
    EXPECT_TRUE(pad.update(reading, dt).empty());
    reading.axes[5] = 0.2f;
    EXPECT_NEAR(pad.update(reading, dt)[0].value, 0.6f, 1e-6f);
}

TEST(CommandPad, LosingThePadStopsSuction) {
    CommandPad pad;
    Reading reading;
    reading.buttons = 1;
    ASSERT_EQ(pad.update(reading, dt).size(), 1u);
    reading.present = false;
    const auto sent = pad.update(reading, dt);
    ASSERT_EQ(sent.size(), 1u);
    EXPECT_EQ(sent[0].value, 0.0f);
    EXPECT_TRUE(pad.update(reading, dt).empty());
}

}  // namespace
}  // namespace eti::devices
