// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/hand_keys.hpp"

#include <gtest/gtest.h>

#include <string>

#include <fmt/format.h>

#include "client/app/window/command_keys.hpp"

namespace eti {
namespace {

// "+" pressed, "=" held, "-" released, each before the command that the key is bound to.
std::string said(const std::vector<client::KeyEvent>& events) {
    std::string out;
    for (const client::KeyEvent& event : events) {
        const client::CommandKey* const key = client::command_key(event.key);
        out += fmt::format("{}{}{}", out.empty() ? "" : " ",
                           !event.down      ? '-'
                           : event.repeated ? '='
                                            : '+',
                           key != nullptr
                               ? fmt::format("{}{:+.0f}", key->command,
                                             key->action == client::KeyAction::step ? key->amount : 0.0f)
                               : "nothing");
    }
    return out;
}

hmd::HandInput pulling(float trigger) {
    hmd::HandInput out;
    out.hands[1].trigger = trigger;
    return out;
}

TEST(HandKeys, TriggerHysteresisKeepsSuctionOn) {
    client::HandKeys hands;
    EXPECT_EQ(said(hands.follow(pulling(0.4f))), "");
    EXPECT_EQ(said(hands.follow(pulling(0.6f))), "+suction+0");
    EXPECT_EQ(said(hands.follow(pulling(0.4f))), "=suction+0");
    EXPECT_EQ(said(hands.follow(pulling(0.2f))), "-suction+0");
    EXPECT_EQ(said(hands.follow(pulling(0.4f))), "");
}

TEST(HandKeys, PadMovesOneAxisAtATime) {
    client::HandKeys hands;
    EXPECT_EQ(said(hands.follow({.head_and_jaw = {0.2f, 0.9f, true}})), "+head_elevation+1");
    EXPECT_EQ(said(hands.follow({.head_and_jaw = {0.2f, 0.9f, true}})), "=head_elevation+1");
    EXPECT_EQ(said(hands.follow({.head_and_jaw = {0.9f, 0.2f, true}})), "-head_elevation+1 +jaw_opening+1");
    EXPECT_EQ(said(hands.follow({.head_and_jaw = {-0.9f, 0.2f, true}})), "-jaw_opening+1 +jaw_opening-1");
    EXPECT_EQ(said(hands.follow({.head_and_jaw = {0.0f, -0.9f, true}})), "-jaw_opening-1 +head_elevation-1");
    EXPECT_EQ(said(hands.follow({.head_and_jaw = {0.1f, 0.1f, true}})), "-head_elevation-1")
        << "in its middle";
    EXPECT_EQ(said(hands.follow({.head_and_jaw = {0.0f, 0.9f, false}})), "") << "touched, not pressed";
}

TEST(HandKeys, SecondPadTiltsTableOnly) {
    client::HandKeys hands;
    EXPECT_EQ(said(hands.follow({.table = {0.0f, 0.9f, true}})), "+table_angle+1");
    EXPECT_EQ(said(hands.follow({.table = {0.0f, -0.9f, true}})), "-table_angle+1 +table_angle-1");
    EXPECT_EQ(said(hands.follow({.table = {0.9f, 0.0f, true}})), "-table_angle-1");
}

TEST(HandKeys, TwoButtonsMoveHeadWithoutPad) {
    client::HandKeys hands;
    EXPECT_EQ(said(hands.follow({.head_up = true})), "+head_elevation+1");
    EXPECT_EQ(said(hands.follow({.head_down = true})), "-head_elevation+1 +head_elevation-1");
    EXPECT_EQ(said(hands.follow({.enhanced = true})), "-head_elevation-1 +view_enhanced+0");
}

TEST(HandKeys, LosingHandsReleasesCommands) {
    client::HandKeys hands;
    (void)hands.follow({.hands = pulling(1.0f).hands, .table = {0.0f, 0.9f, true}});
    EXPECT_EQ(said(hands.follow({})), "-table_angle+1 -suction+0");
    EXPECT_EQ(said(hands.follow({})), "");
}

}  // namespace
}  // namespace eti
