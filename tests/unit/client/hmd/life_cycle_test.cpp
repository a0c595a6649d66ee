// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/life_cycle.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace eti::hmd {
namespace {

using enum SessionState;

std::vector<Duty> through(LifeCycle& life, std::initializer_list<SessionState> states) {
    std::vector<Duty> out;
    for (const SessionState state : states) {
        out.push_back(life.enter(state));
    }
    return out;
}

// OpenXR 1.0, figure 2 "Session life cycle": from being made to being worn.
TEST(LifeCycle, BeginsWhenTheRuntimeIsReadyAndShowsWhenItIsVisible) {
    LifeCycle life;
    EXPECT_FALSE(life.running());
    EXPECT_EQ(through(life, {idle, ready}), (std::vector{Duty::none, Duty::begin_session}));
    EXPECT_TRUE(life.running());
    EXPECT_FALSE(life.visible());
    (void)life.enter(synchronized);
    EXPECT_FALSE(life.visible()) << "frames are paced, but nobody sees them";
    (void)life.enter(visible);
    EXPECT_TRUE(life.visible());
    EXPECT_FALSE(life.focused());
    (void)life.enter(focused);
    EXPECT_TRUE(life.focused());
}

TEST(LifeCycle, AMenuOfTheRuntimeHasTheHandsMeanwhile) {
    LifeCycle life;
    (void)through(life, {idle, ready, synchronized, visible, focused, visible});
    EXPECT_TRUE(life.visible());
    EXPECT_FALSE(life.focused());
    (void)life.enter(focused);
    EXPECT_TRUE(life.focused());
}

TEST(LifeCycle, AHeadsetPutAsideEndsTheSessionAndBeginsItAgain) {
    LifeCycle life;
    (void)through(life, {idle, ready, synchronized, visible, focused});
    EXPECT_EQ(through(life, {visible, synchronized, stopping}),
              (std::vector{Duty::none, Duty::none, Duty::end_session}));
    EXPECT_FALSE(life.running());
    EXPECT_EQ(life.end(), SessionEnd::none) << "it may be put on again";
    EXPECT_EQ(through(life, {idle, ready}), (std::vector{Duty::none, Duty::begin_session}));
    EXPECT_TRUE(life.running());
}

TEST(LifeCycle, WhatWasDoneIsNotDoneAgain) {
    LifeCycle life;
    EXPECT_EQ(through(life, {stopping, ready, ready}),
              (std::vector{Duty::none, Duty::begin_session, Duty::none}));
    EXPECT_EQ(through(life, {stopping, stopping}), (std::vector{Duty::end_session, Duty::none}));
}

TEST(LifeCycle, WhoeverWearsItMayLeave) {
    LifeCycle life;
    (void)through(
        life, {idle, ready, synchronized, visible, focused, visible, synchronized, stopping, idle, exiting});
    EXPECT_EQ(life.end(), SessionEnd::left);
    EXPECT_EQ(life.enter(ready), Duty::none) << "what is over stays over";
    EXPECT_FALSE(life.running());
}

TEST(LifeCycle, TheProgramAsksTheRuntimeOnlyWhileItRuns) {
    LifeCycle running;
    (void)through(running, {idle, ready});
    EXPECT_TRUE(running.ask_to_leave());
    EXPECT_EQ(running.end(), SessionEnd::none) << "the runtime leads to the end";
    LifeCycle unworn;
    (void)unworn.enter(idle);
    EXPECT_FALSE(unworn.ask_to_leave());
    EXPECT_EQ(unworn.end(), SessionEnd::left);
}

TEST(LifeCycle, TheFirstLossCounts) {
    LifeCycle headset;
    (void)through(headset, {idle, ready, synchronized, visible, loss_pending});
    EXPECT_EQ(headset.end(), SessionEnd::headset_gone);
    EXPECT_FALSE(headset.running()) << "no call may follow but that which destroys it";
    headset.lose(SessionEnd::runtime_gone);
    EXPECT_EQ(headset.end(), SessionEnd::headset_gone);
    LifeCycle runtime;
    (void)through(runtime, {idle, ready, synchronized});
    runtime.lose(SessionEnd::runtime_gone);
    EXPECT_EQ(runtime.enter(stopping), Duty::none);
    EXPECT_EQ(runtime.end(), SessionEnd::runtime_gone);
}

}  // namespace
}  // namespace eti::hmd
