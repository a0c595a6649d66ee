// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hmd/life_cycle.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

namespace eti::hmd {
namespace {

constexpr XrSessionState idle = XR_SESSION_STATE_IDLE, ready = XR_SESSION_STATE_READY,
                         synchronized = XR_SESSION_STATE_SYNCHRONIZED, visible = XR_SESSION_STATE_VISIBLE,
                         focused = XR_SESSION_STATE_FOCUSED, stopping = XR_SESSION_STATE_STOPPING,
                         loss_pending = XR_SESSION_STATE_LOSS_PENDING, exiting = XR_SESSION_STATE_EXITING;

std::vector<RequiredCall> through(LifeCycle& life, std::initializer_list<XrSessionState> states) {
    std::vector<RequiredCall> out;
    for (const XrSessionState state : states) {
        out.push_back(life.enter(state));
    }
    return out;
}

// OpenXR 1.0, figure 2 "Session life cycle": from creation to the focused state.
TEST(LifeCycle, BeginsWhenReadyAndShowsWhenVisible) {
    LifeCycle life;
    EXPECT_FALSE(life.running());
    EXPECT_EQ(through(life, {idle, ready}), (std::vector{RequiredCall::none, RequiredCall::begin_session}));
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

TEST(LifeCycle, RuntimeMenuTakesFocus) {
    LifeCycle life;
    (void)through(life, {idle, ready, synchronized, visible, focused, visible});
    EXPECT_TRUE(life.visible());
    EXPECT_FALSE(life.focused());
    (void)life.enter(focused);
    EXPECT_TRUE(life.focused());
}

TEST(LifeCycle, DoffingEndsSessionAndDonningRestartsIt) {
    LifeCycle life;
    (void)through(life, {idle, ready, synchronized, visible, focused});
    EXPECT_EQ(through(life, {visible, synchronized, stopping}),
              (std::vector{RequiredCall::none, RequiredCall::none, RequiredCall::end_session}));
    EXPECT_FALSE(life.running());
    EXPECT_EQ(life.end(), SessionEnd::none) << "it may be put on again";
    EXPECT_EQ(through(life, {idle, ready}), (std::vector{RequiredCall::none, RequiredCall::begin_session}));
    EXPECT_TRUE(life.running());
}

TEST(LifeCycle, RepeatedStateHasNoEffect) {
    LifeCycle life;
    EXPECT_EQ(through(life, {stopping, ready, ready}),
              (std::vector{RequiredCall::none, RequiredCall::begin_session, RequiredCall::none}));
    EXPECT_EQ(through(life, {stopping, stopping}),
              (std::vector{RequiredCall::end_session, RequiredCall::none}));
}

TEST(LifeCycle, WearerCanExit) {
    LifeCycle life;
    (void)through(
        life, {idle, ready, synchronized, visible, focused, visible, synchronized, stopping, idle, exiting});
    EXPECT_EQ(life.end(), SessionEnd::left);
    EXPECT_EQ(life.enter(ready), RequiredCall::none) << "what is over stays over";
    EXPECT_FALSE(life.running());
}

TEST(LifeCycle, RequestsExitOnlyWhileRunning) {
    LifeCycle running;
    (void)through(running, {idle, ready});
    EXPECT_TRUE(running.request_exit());
    EXPECT_EQ(running.end(), SessionEnd::none) << "the runtime leads to the end";
    LifeCycle unworn;
    (void)unworn.enter(idle);
    EXPECT_FALSE(unworn.request_exit());
    EXPECT_EQ(unworn.end(), SessionEnd::left);
}

TEST(LifeCycle, KeepsFirstLossReason) {
    LifeCycle headset;
    (void)through(headset, {idle, ready, synchronized, visible, loss_pending});
    EXPECT_EQ(headset.end(), SessionEnd::headset_lost);
    EXPECT_FALSE(headset.running()) << "no call may follow but that which destroys it";
    headset.end_with(SessionEnd::runtime_lost);
    EXPECT_EQ(headset.end(), SessionEnd::headset_lost);
    LifeCycle runtime;
    (void)through(runtime, {idle, ready, synchronized});
    runtime.end_with(SessionEnd::runtime_lost);
    EXPECT_EQ(runtime.enter(stopping), RequiredCall::none);
    EXPECT_EQ(runtime.end(), SessionEnd::runtime_lost);
}

}  // namespace
}  // namespace eti::hmd
