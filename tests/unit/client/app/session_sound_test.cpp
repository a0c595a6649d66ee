// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/session_sound.hpp"

#include <gtest/gtest.h>

#include "synthetic_scene.hpp"

namespace eti {
namespace {

class SessionSound : public ::testing::Test {
  protected:
    SessionSound() { synthetic::fill(seen_, scene_); }
    void session(float gum_force, float suction) {
        msg::LiveMetrics metrics = synthetic::metrics(scene_, time_ns_ += 10'000'000, 0.0f);
        synthetic::set(metrics, &LiveMeasures::gum_force_n, gum_force);
        RuntimeParameters live;
        live.suction = suction;
        bus::set_runtime_parameters(live, metrics);
        ASSERT_TRUE(seen_.apply(metrics));
        ASSERT_TRUE(seen_.apply(synthetic::status(msg::PHASE_RUNNING)));
    }
    synthetic::Scene scene_ = synthetic::make_scene();
    view::SceneView seen_;
    std::uint64_t time_ns_ = 2'000'000'000;
};

TEST_F(SessionSound, GumAndSuctionCuesMatchScreen) {
    session(3.9f, 0.0f);
    EXPECT_FALSE(client::cue_of(seen_, false).gum_pressed);
    EXPECT_FALSE(client::cue_of(seen_, false).suction);
    session(4.1f, 1.0f);
    EXPECT_TRUE(client::cue_of(seen_, false).gum_pressed) << "red on the screen";
    EXPECT_TRUE(client::cue_of(seen_, false).suction);
}

TEST_F(SessionSound, IsSilentWhenServerIsLost) {
    session(9.0f, 1.0f);
    const sound::Cue cue = client::cue_of(seen_, true);
    EXPECT_FALSE(cue.pulse || cue.gum_pressed || cue.suction);
}

}  // namespace
}  // namespace eti
