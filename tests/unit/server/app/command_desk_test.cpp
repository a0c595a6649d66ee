// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/command_desk.hpp"

#include <gtest/gtest.h>

#include <limits>

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

}  // namespace
}  // namespace eti::app
