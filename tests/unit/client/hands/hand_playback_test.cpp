// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/hand_playback.hpp"

#include <gtest/gtest.h>

#include "common/scenario/data_file.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

using hands::HandPlayback;
using hands::Hands;

constexpr float hand_play_dt = 1.0f / 180.0f;

class HandPlayTest : public ::testing::Test {
  protected:
    void SetUp() override { synthetic::fill(seen_, scene_); }
    void play(HandPlayback& list, int steps) {
        for (int i = 0; i < steps; ++i) {
            list.advance(hand_play_dt, hands_, seen_, {});
            hands_.advance(hand_play_dt, {}, {});
        }
    }
    synthetic::Scene scene_ = synthetic::make_scene();
    view::SceneView seen_;
    Hands hands_{make_laryngoscope(Blade::miller_1), Tube(), scene_.landmarks};
};

TEST_F(HandPlayTest, MatchesMouseAndKeyInput) {
    HandPlayback list = HandPlayback::parse(R"(
steps:
  - {step: aside, view: section, right_px: 30, down_px: 12, over_s: 0.5}
  - {step: lift, key: w, over_s: 0.5}
  - {step: tube, hand: tube, notches: 4, over_s: 0.2}
)",
                                            "test");
    Hands same(make_laryngoscope(Blade::miller_1), Tube(), scene_.landmarks);
    play(list, 300);
    EXPECT_TRUE(list.finished());
    const render::View* const section = render::view_named("section");
    same.drag({{.x = 30.0f, .y = 12.0f}, section->camera(seen_, {}), 540.0f}, seen_.landmarks());
    for (int i = 0; i < 200; ++i) {
        same.advance(hand_play_dt, {}, {});
    }
    (void)same.press(U'w');
    for (int i = 0; i < 90; ++i) {
        same.advance(hand_play_dt, {}, {});
    }
    same.release(U'w');
    (void)same.press(hands::other_hand_key);
    same.drag({{.notches = 4.0f}, {}, 540.0f}, seen_.landmarks());
    for (int i = 0; i < 200; ++i) {
        same.advance(hand_play_dt, {}, {});
    }
    EXPECT_EQ(hands_.chosen(), Tool::tube);
    for (const Tool tool : {Tool::laryngoscope, Tool::tube}) {
        // A key is held for whole steps: half a step's lift, 0.04 mm, besides rounding.
        EXPECT_NEAR((hands_.held(tool).tip() - same.held(tool).tip()).norm(), 0.0f, 1e-4f);
    }
}

TEST_F(HandPlayTest, AdvancesWhenGlottisIsVisible) {
    HandPlayback list = HandPlayback::parse(
        "steps: [{step: look, view: eye, over_s: 20, until: {view_percent: 50}}, {step: on, over_s: 1}]",
        "test");
    seen_.apply(synthetic::metrics(scene_, 2'000'000'000, 40.0f));
    play(list, 100);
    EXPECT_EQ(list.step(), 0u);
    seen_.apply(synthetic::metrics(scene_, 3'000'000'000, 60.0f));
    play(list, 2);
    EXPECT_EQ(list.step(), 1u);
}

TEST(HandPlayback, RejectsInvalidSteps) {
    EXPECT_THROW((void)HandPlayback::parse("steps: [{step: a, key: p}]", "test"), InputError);
    EXPECT_THROW((void)HandPlayback::parse("steps: [{step: a, view: nowhere}]", "test"), InputError);
    EXPECT_THROW((void)HandPlayback::parse("steps: [{step: a, over_s: -1}]", "test"), InputError);
    EXPECT_THROW((void)HandPlayback::parse("steps: [{step: a, force_n: 3}]", "test"), InputError);
}

}  // namespace
}  // namespace eti
