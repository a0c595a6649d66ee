// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/tutorial.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "common/bus/codec/convert.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

using client::Tutorial;

class TutorialTest : public ::testing::Test {
  protected:
    TutorialTest() { synthetic::fill(seen_, scene_); }
    void look(std::string_view view = "section") { tutorial_.update({seen_, view}); }
    // Places the blade's tip this far [m] past the upper gum, towards the glottis.
    void blade_at(float depth) {
        const Vec3f& gum = at(scene_.landmarks, Landmark::upper_gum);
        const Vec3f tip = gum + depth * (at(scene_.landmarks, Landmark::glottis) - gum).normalized();
        msg::ProxyState proxy = synthetic::proxy(scene_, time_ns_ += 10'000'000);
        const RigidTransform now = bus::from_msg(proxy.proxy());
        proxy.proxy(bus::to_msg(
            RigidTransform{now.rotation, tip - now.rotation * seen_.keys()->laryngoscope().tip()}));
        ASSERT_TRUE(seen_.apply(proxy));
    }
    void session(bool attempt, float percent, msg::TubePlace place, float depth) {
        msg::LiveMetrics metrics = synthetic::metrics(scene_, time_ns_ += 10'000'000, percent);
        metrics.attempt_running(attempt);
        metrics.tube_place(place);
        synthetic::set(metrics, &LiveMeasures::tube_depth_past_glottis, depth);
        ASSERT_TRUE(seen_.apply(metrics));
    }

    synthetic::Scene scene_ = synthetic::make_scene();
    view::SceneView seen_;
    Tutorial tutorial_;
    std::uint64_t time_ns_ = 2'000'000'000;
};

TEST_F(TutorialTest, AdvancesWithSessionState) {
    session(false, 0.0f, msg::TUBE_OUTSIDE, -0.05f);
    look("eye");
    EXPECT_EQ(tutorial_.lesson(), 0u);
    look("section");
    EXPECT_EQ(tutorial_.lesson(), 1u);
    session(true, 0.0f, msg::TUBE_OUTSIDE, -0.05f);
    blade_at(0.028f);
    look();
    EXPECT_EQ(tutorial_.lesson(), 1u) << "3 cm are asked for";
    blade_at(0.032f);
    look();
    EXPECT_EQ(tutorial_.lesson(), 2u);
    session(true, 49.0f, msg::TUBE_OUTSIDE, -0.05f);
    look();
    EXPECT_EQ(tutorial_.lesson(), 2u);
    session(true, 51.0f, msg::TUBE_OUTSIDE, -0.05f);
    look();
    EXPECT_EQ(tutorial_.lesson(), 3u);
    session(true, 51.0f, msg::TUBE_IN_OESOPHAGUS, 0.02f);
    look();
    EXPECT_EQ(tutorial_.lesson(), 3u) << "not there";
    session(true, 51.0f, msg::TUBE_IN_TRACHEA, 0.016f);
    look();
    EXPECT_EQ(tutorial_.lesson(), 4u);
    ASSERT_TRUE(seen_.apply(synthetic::summary(1, true, time_ns_)));
    look();
    EXPECT_TRUE(tutorial_.finished());
    hud::Readout readout;
    tutorial_.add_to(readout);
    EXPECT_TRUE(readout.guidance.empty());
}

TEST_F(TutorialTest, FailedAttemptRestartsAtBladeStep) {
    look();
    tutorial_.skip();
    tutorial_.skip();
    session(false, 0.0f, msg::TUBE_OUTSIDE, -0.05f);
    ASSERT_TRUE(seen_.apply(synthetic::summary(1, false, time_ns_)));
    look();
    EXPECT_EQ(tutorial_.lesson(), 1u);
    hud::Readout readout;
    tutorial_.add_to(readout);
    EXPECT_NE(readout.guidance.at(1).find(seen_.attempt_report()->outcome.reason), std::string::npos);
}

TEST_F(TutorialTest, ManikinAttemptEndCompletesTutorial) {
    look();
    for (std::size_t step = 0; step + 1 < client::lessons().size(); ++step) {
        tutorial_.skip();
    }
    msg::AttemptSummary ended = synthetic::summary(1, false, time_ns_);
    ended.parameters(bus::to_msg(synthetic::manikin_metrics()));
    ASSERT_TRUE(seen_.apply(ended));
    look();
    EXPECT_TRUE(tutorial_.finished());
}

TEST_F(TutorialTest, AnyStepCanBeSkipped) {
    for (std::size_t step = 0; step < client::lessons().size(); ++step) {
        EXPECT_FALSE(tutorial_.finished());
        tutorial_.skip();
    }
    EXPECT_TRUE(tutorial_.finished());
    tutorial_.skip();
    EXPECT_EQ(tutorial_.lesson(), client::lessons().size());
}

TEST(TutorialMark, LiesInUserConfigFolder) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("eti-settings-" + std::to_string(::getpid()));
    ::setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
    EXPECT_FALSE(client::tutorial_was_shown());
    client::mark_tutorial_shown();
    EXPECT_TRUE(client::tutorial_was_shown());
    EXPECT_EQ(client::tutorial_marker_file(), folder / "neoeti" / "tutorial-shown");
    std::filesystem::remove_all(folder);
    // The specification: a path that is not absolute is ignored.
    ::setenv("XDG_CONFIG_HOME", "relative", 1);
    ::setenv("HOME", "/home/somebody", 1);
    EXPECT_EQ(client::tutorial_marker_file(),
              std::filesystem::path("/home/somebody/.config/neoeti/tutorial-shown"));
    ::unsetenv("XDG_CONFIG_HOME");
}

}  // namespace
}  // namespace eti
