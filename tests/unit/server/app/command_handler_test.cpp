// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/commands/command_handler.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "common/math/units.hpp"

namespace eti::app {
namespace {

TEST(ReadableText, ExternalTextBecomesOneValidLine) {
    EXPECT_EQ(sanitized_text("tongue swept aside"), "tongue swept aside");
    EXPECT_EQ(sanitized_text("Z\xc3\xbcrich"), "Z\xc3\xbcrich");
    EXPECT_EQ(sanitized_text("a\xff\xfe"), "a\xef\xbf\xbd\xef\xbf\xbd");
    EXPECT_EQ(sanitized_text("a\nb\x1b[2Jc\x7f"), "a b [2Jc ");
    EXPECT_EQ(sanitized_text(std::string("a\0b", 3)), "a b");
}

TEST(CommandHandler, SwitchAcceptsOnlyZeroOrOne) {
    CommandHandler desk;
    desk.handle({"test", 1, "view_enhanced", 1.0f});
    EXPECT_TRUE(desk.answer().accepted());
    desk.handle({"test", 2, "view_enhanced", 0.5f});
    EXPECT_FALSE(desk.answer().accepted());
    EXPECT_NE(desk.answer().reason().to_string().find("expected 0 or 1"), std::string::npos);
    EXPECT_EQ(desk.wanted().view_enhanced, 1.0f);
}

TEST(CommandHandler, SuctionKeepsLastValidValue) {
    CommandHandler desk;
    EXPECT_EQ(desk.wanted().suction, 0.0f);
    desk.handle({"trainee", 1, "suction", 0.75f});
    EXPECT_TRUE(desk.answer().accepted());
    EXPECT_EQ(desk.wanted().suction, 0.75f);
    for (const float wrong : {-0.1f, 1.1f, std::numeric_limits<float>::quiet_NaN()}) {
        desk.handle({"trainee", 2, "suction", wrong});
        EXPECT_FALSE(desk.answer().accepted()) << wrong;
        EXPECT_EQ(desk.wanted().suction, 0.75f) << wrong;
    }
    desk.handle({"trainee", 3, "suction", 0.0f});
    EXPECT_EQ(desk.wanted().suction, 0.0f);
}

TEST(CommandHandler, NextIsRefusedInLastSession) {
    CommandHandler last;
    last.handle({"instructor", 1, "next", 1.0f});
    EXPECT_FALSE(last.answer().accepted());
    EXPECT_NE(last.answer().reason().to_string().find("--scenario A --scenario B"), std::string::npos);
    EXPECT_FALSE(last.next());
    CommandHandler followed({}, {}, true);
    EXPECT_FALSE(followed.next());
    followed.handle({"instructor", 1, "next", 1.0f});
    EXPECT_TRUE(followed.answer().accepted());
    EXPECT_TRUE(followed.next());
    EXPECT_FALSE(followed.stopped());
}

struct Case {
    const char* name;
    float value;
    const char* refusal;  // a part of the message; nullptr: accepted
};

PatientLimits limits() {
    PatientLimits l;
    l.tongue_scale = 1.15f;
    return l;
}

TEST(CommandHandler, RefusesValuesOutsidePatientLimits) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Case& c :
         {Case{"table_angle", -20.0f * degree, nullptr},
          Case{"table_angle", 20.1f * degree, "20.1 deg, expected -20 to 20"},
          Case{"table_angle", nan, "table angle"}, Case{"head_elevation", -0.1f * degree, "expected 0 to 30"},
          Case{"head_scale", 1.15f, nullptr}, Case{"head_scale", 1.16f, "1.16, expected 0.85 to 1.15"},
          Case{"head_scale", nan, "head scale"}, Case{"tongue_scale", 1.4f, nullptr},
          Case{"tongue_scale", 0.79f, "0.79, expected 0.8 to 1.4"}, Case{"tongue_scale", nan, "tongue scale"},
          Case{"tissue_stiffness", 99.9e3f, nullptr},
          Case{"tissue_stiffness", 900.0f, "0.9 kPa, expected 1 to 100"},
          Case{"tissue_stiffness", nan, "tissue stiffness"}, Case{"secretion", 1.0f, "saliva: standby"},
          Case{"muscle_tone", 0.0f, nullptr}, Case{"muscle_tone", 0.5f, "bones_yield: on"},
          Case{"laryngeal_pressure_back", 3.0f, "bones_yield: on"},
          Case{"laryngeal_pressure_back", 10.5f, "10.5 N, expected 0 to 10"}}) {
        CommandHandler desk(limits(), {.tongue_scale = 1.15f});
        const RuntimeParameters before = desk.wanted();
        desk.handle({"instructor", 1, c.name, c.value});
        const std::string reason = desk.answer().reason().to_string();
        EXPECT_EQ(desk.answer().accepted(), c.refusal == nullptr) << reason;
        if (c.refusal != nullptr) {
            EXPECT_NE(reason.find(c.refusal), std::string::npos) << reason;
            EXPECT_LT(reason.size(), 199u) << "nothing was cut off";
            EXPECT_EQ(desk.wanted(), before);
        }
    }
}

TEST(CommandHandler, SecretionIsAcceptedUpToItsLimit) {
    PatientLimits wet = limits();
    wet.saliva = true;
    CommandHandler desk(wet);
    desk.handle({"instructor", 1, "secretion", 10.0f});
    EXPECT_TRUE(desk.answer().accepted());
    EXPECT_EQ(desk.wanted().secretion, 10.0f);
    desk.handle({"instructor", 2, "secretion", 10.1f});
    EXPECT_FALSE(desk.answer().accepted());
    EXPECT_EQ(desk.wanted().secretion, 10.0f);
}

TEST(CommandHandler, UnknownCommandIsNamed) {
    CommandHandler desk;
    for (const char* name : {"tooth_count", "", "Suction", "head_elevation_deg"}) {
        desk.handle({"instructor", 1, name, 0.5f});
        EXPECT_FALSE(desk.answer().accepted()) << name;
        EXPECT_NE(desk.answer().reason().to_string().find(fmt::format("'{}'", name)), std::string::npos);
        EXPECT_EQ(desk.wanted(), RuntimeParameters{});
    }
}

TEST(CommandHandler, RuntimeParametersAcceptTheirRangeLimits) {
    PatientLimits wet;
    wet.saliva = true;
    wet.bones_yield = true;
    for (const RuntimeParameterField& field : runtime_parameter_fields) {
        for (const float typed : {field.low, field.high}) {
            CommandHandler desk(wet);
            desk.handle({"instructor", 1, std::string(field.name), typed * field.per_unit});
            EXPECT_TRUE(desk.answer().accepted()) << field.name << ' ' << desk.answer().reason().to_string();
            EXPECT_EQ(desk.wanted().*field.value, typed * field.per_unit) << field.name;
        }
    }
}

}  // namespace
}  // namespace eti::app
