// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/command_desk.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "common/math/units.hpp"

namespace eti::app {
namespace {

TEST(CommandDesk, SuctionStaysAsAskedFor) {
    CommandDesk desk;
    scene::Inputs inputs;
    EXPECT_EQ(desk.suction(), 0.0f);
    desk.handle({"trainee", 1, msg::COMMAND_SUCTION, 0.75f}, inputs);
    EXPECT_TRUE(desk.answer().accepted());
    EXPECT_EQ(desk.suction(), 0.75f);
    for (const float wrong : {-0.1f, 1.1f, std::numeric_limits<float>::quiet_NaN()}) {
        desk.handle({"trainee", 2, msg::COMMAND_SUCTION, wrong}, inputs);
        EXPECT_FALSE(desk.answer().accepted()) << wrong;
        EXPECT_EQ(desk.suction(), 0.75f) << wrong;
    }
    desk.handle({"trainee", 3, msg::COMMAND_SUCTION, 0.0f}, inputs);
    EXPECT_EQ(desk.suction(), 0.0f);
}

struct Case {
    msg::CommandKind kind;
    float value;
    const char* refusal;  // a part of it; nullptr: accepted
};

PatientLimits limits() {
    PatientLimits l;
    l.tongue_scale = 1.15f;
    l.stiffest = 20e3f;
    l.bearer = "tetrahedra of 2 mm";
    return l;
}

TEST(CommandDesk, AnswersWhatThePatientDoesNotBear) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Case& c :
         {Case{msg::COMMAND_TABLE_ANGLE, -20.0f * degree, nullptr},
          Case{msg::COMMAND_TABLE_ANGLE, 20.1f * degree, "20.1 deg, expected -20 to 20"},
          Case{msg::COMMAND_TABLE_ANGLE, nan, "table angle"},
          Case{msg::COMMAND_HEAD_ELEVATION, -0.1f * degree, "expected 0 to 30"},
          Case{msg::COMMAND_HEAD_SCALE, 1.15f, nullptr},
          Case{msg::COMMAND_HEAD_SCALE, 1.16f, "1.16, expected 0.85 to 1.15"},
          Case{msg::COMMAND_HEAD_SCALE, nan, "head scale"}, Case{msg::COMMAND_TONGUE_SCALE, 1.4f, nullptr},
          Case{msg::COMMAND_TONGUE_SCALE, 0.79f, "0.79, expected 0.8 to 1.4"},
          Case{msg::COMMAND_TONGUE_SCALE, nan, "tongue scale"},
          Case{msg::COMMAND_TISSUE_STIFFNESS, 19.9e3f, nullptr},
          Case{msg::COMMAND_TISSUE_STIFFNESS, 20.2e3f, "tetrahedra of 2 mm bear at most 20"},
          Case{msg::COMMAND_TISSUE_STIFFNESS, 900.0f, "0.9 kPa, expected 1 to 100"},
          Case{msg::COMMAND_TISSUE_STIFFNESS, nan, "tissue stiffness"},
          Case{msg::COMMAND_SECRETION, 1.0f, "saliva: standby"}}) {
        CommandDesk desk(limits());
        scene::Inputs inputs;
        desk.handle({"instructor", 1, c.kind, c.value}, inputs);
        const std::string reason = desk.answer().reason().to_string();
        EXPECT_EQ(desk.answer().accepted(), c.refusal == nullptr) << reason;
        if (c.refusal != nullptr) {
            EXPECT_NE(reason.find(c.refusal), std::string::npos) << reason;
            EXPECT_LT(reason.size(), 199u) << "nothing was cut off";
            EXPECT_FALSE(inputs.head_scale || inputs.tongue_scale || inputs.tissue_stiffness);
            EXPECT_EQ(inputs.posture, anatomy::Posture{});
        }
    }
}

TEST(CommandDesk, ALargerTongueBearsLessStiffness) {
    CommandDesk desk(limits());
    scene::Inputs inputs;
    const auto ask = [&](msg::CommandKind kind, float value) {
        desk.handle({"instructor", 1, kind, value}, inputs);
        return desk.answer().accepted();
    };
    // 20 kPa at 1.15 is 17.7 kPa at 1.3.
    EXPECT_TRUE(ask(msg::COMMAND_TISSUE_STIFFNESS, 18e3f));
    EXPECT_FALSE(ask(msg::COMMAND_TONGUE_SCALE, 1.3f));
    EXPECT_TRUE(ask(msg::COMMAND_TISSUE_STIFFNESS, 17e3f));
    EXPECT_TRUE(ask(msg::COMMAND_TONGUE_SCALE, 1.3f));
    EXPECT_FALSE(ask(msg::COMMAND_TISSUE_STIFFNESS, 18e3f));
    EXPECT_EQ(inputs.tissue_stiffness, 17e3f);
    EXPECT_EQ(inputs.tongue_scale, 1.3f);
}

TEST(CommandDesk, SecretionsNeedLiquid) {
    PatientLimits wet = limits();
    wet.saliva = true;
    CommandDesk desk(wet);
    scene::Inputs inputs;
    desk.handle({"instructor", 1, msg::COMMAND_SECRETION, 10.0f}, inputs);
    EXPECT_TRUE(desk.answer().accepted());
    EXPECT_EQ(inputs.secretion, 10.0f);
    desk.handle({"instructor", 2, msg::COMMAND_SECRETION, 10.1f}, inputs);
    EXPECT_FALSE(desk.answer().accepted());
    EXPECT_EQ(inputs.secretion, 10.0f);
}

TEST(CommandDesk, EveryKindHasAName) {
    for (std::uint32_t kind = msg::COMMAND_START; kind <= msg::COMMAND_SECRETION; ++kind) {
        EXPECT_NE(name_of(static_cast<msg::CommandKind>(kind)), "unknown") << kind;
    }
}

}  // namespace
}  // namespace eti::app
