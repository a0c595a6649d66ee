// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/command_keys.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "client/app/window/selection.hpp"
#include "common/math/units.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;
using client::command_key;

class CommandKeys : public ::testing::Test {
  protected:
    // The value that a key sends, NaN if it sends nothing.
    float press(char32_t key, client::CommandKeyMapper::Time::duration when, bool repeated = false) {
        const auto command =
            typing_.press(*command_key(key), repeated, patient_, client::CommandKeyMapper::Time(when));
        return command ? command->value : std::numeric_limits<float>::quiet_NaN();
    }

    client::CommandKeyMapper typing_;
    RuntimeParameters patient_{.head_elevation = 10.0f * degree};
};

TEST_F(CommandKeys, AreUniqueAndNameExistingCommands) {
    std::set<char32_t> taken{U'h', U'?'};
    for (const client::Selection& one : client::selections()) {
        taken.insert(static_cast<char32_t>(one.key));
    }
    for (const client::CommandKey& key : client::command_keys()) {
        EXPECT_TRUE(taken.insert(key.key).second) << key.caption;
        EXPECT_TRUE(key.action == client::KeyAction::once || find_runtime_parameter(key.command) != nullptr)
            << key.command;
        EXPECT_FALSE(key.help.empty()) << key.caption;
    }
    EXPECT_EQ(command_key(U'q'), nullptr);
}

TEST_F(CommandKeys, StepFromRequestThenFromPatientState) {
    EXPECT_FLOAT_EQ(press(client::key_up, 10s), 11.0f * degree);
    // The patient has not followed yet.
    EXPECT_FLOAT_EQ(press(client::key_up, 10'200ms), 12.0f * degree);
    EXPECT_FLOAT_EQ(press(client::key_down, 10'400ms), 11.0f * degree);
    // Meanwhile the assistant has moved it.
    patient_.head_elevation = 20.0f * degree;
    EXPECT_FLOAT_EQ(press(client::key_up, 12s), 21.0f * degree);
}

TEST_F(CommandKeys, HeldKeyStepsAtPostureRate) {
    int steps = 0;
    (void)press(U']', 10s);
    for (int i = 1; i <= 60; ++i) {
        steps += std::isnan(press(U']', 10s + i * 33ms, true)) ? 0 : 1;
    }
    // Every fourth of the repeats, 33 ms apart, is the first after 100 ms.
    EXPECT_EQ(steps, 15);
}

TEST_F(CommandKeys, SendNothingOutsideRangeOrFromUnknownValue) {
    EXPECT_TRUE(std::isnan(press(client::key_left, 10s))) << "the jaw is closed";
    const RuntimeParameterField& jaw = *find_runtime_parameter("jaw_opening");
    patient_.jaw_opening = jaw.high * jaw.per_unit - 0.5f * degree;
    EXPECT_FLOAT_EQ(press(client::key_right, 20s), jaw.high * jaw.per_unit);
    patient_.table_angle = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(std::isnan(press(U'[', 10s)));
}

TEST_F(CommandKeys, ToggleTurnsOnAndOff) {
    EXPECT_EQ(press(U'e', 10s), 1.0f);
    EXPECT_EQ(press(U'e', 10'100ms), 0.0f) << "before the server has said so";
    EXPECT_TRUE(std::isnan(press(U'e', 10'200ms, true))) << "held";
    patient_.view_enhanced = 1.0f;
    EXPECT_EQ(press(U'e', 20s), 0.0f);
    patient_.view_enhanced = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(std::isnan(press(U'e', 30s))) << "an older server";
}

TEST_F(CommandKeys, SuctionIsOnWhileHeld) {
    EXPECT_FALSE(typing_.release(*command_key(U's')));
    EXPECT_EQ(press(U's', 10s), 1.0f);
    EXPECT_TRUE(std::isnan(press(U's', 10'500ms, true)));
    EXPECT_EQ(typing_.release(*command_key(U's'))->value, 0.0f);
    EXPECT_FALSE(typing_.release(*command_key(U's')));
    EXPECT_FALSE(typing_.release(*command_key(U'r')));
}

TEST_F(CommandKeys, LarynxIsPressedWhileHeld) {
    EXPECT_EQ(press(U'-', 10s), 3.0f);
    EXPECT_TRUE(std::isnan(press(U'-', 10'500ms, true)));
    EXPECT_EQ(typing_.release(*command_key(U'-'))->value, 0.0f);
    EXPECT_FALSE(typing_.release(*command_key(U'-')));
}

}  // namespace
}  // namespace eti
