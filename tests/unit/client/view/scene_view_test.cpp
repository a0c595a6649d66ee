// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/scene_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/bus/codec/fluid_state.hpp"
#include "common/bus/codec/frame_pose.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

class SceneViewTest : public ::testing::Test {
  protected:
    void SetUp() override { synthetic::fill(view_, scene_); }

    // The externally visible state; a rejected message must not change it.
    void expect_refused(bool accepted) {
        EXPECT_FALSE(accepted);
        EXPECT_EQ(view_.dropped(), ++dropped_);
    }

    synthetic::Scene scene_ = synthetic::make_scene();
    view::SceneView view_;
    std::uint64_t dropped_ = 0;
};

TEST_F(SceneViewTest, IsCompleteOnlyWithAllObjects) {
    view::SceneView view;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
        EXPECT_FALSE(view.complete()) << i << " objects";
        EXPECT_TRUE(view.apply(scene_.objects[i]));
    }
    EXPECT_FALSE(view.complete()) << "the session has not described itself";
    EXPECT_TRUE(view.apply(scene_.description));
    EXPECT_TRUE(view.complete());
    EXPECT_EQ(view.surfaces().size(), 5u);
    EXPECT_TRUE(view.laryngoscope().has_value());
    EXPECT_EQ(view.dropped(), 0u);
}

TEST_F(SceneViewTest, SceneMayArriveInAnyOrder) {
    view::SceneView view;
    for (auto object = scene_.objects.rbegin(); object != scene_.objects.rend(); ++object) {
        EXPECT_TRUE(view.apply(*object));
    }
    EXPECT_TRUE(view.apply(scene_.description));
    EXPECT_TRUE(view.complete());
    EXPECT_TRUE(view.apply(synthetic::deformation(scene_, 5, 0.004f, 0.0f)));
    view.update();
    EXPECT_NE(view.tube(), nullptr);
}

TEST_F(SceneViewTest, FramesMoveTheirSkinnedVertices) {
    const auto tongue = [&]() -> const view::SkinnedSurface& { return view_.surfaces().at("tongue"); };
    const Vec3f rest = tongue().model().mesh.vertices.front();
    // fill() lifted the tongue by 3 mm towards anterior (-y); quaternions are exact for the identity.
    EXPECT_NEAR(tongue().vertices().front().position.y(), rest.y() - 0.003f, 1e-7f);
    const std::uint64_t before = view_.surfaces().at("spine").revision();
    msg::DeformationState state;
    state.chunks(1);
    state.header().simulation_time_ns(2'000'000);
    const Quatf quarter(Eigen::AngleAxisf(0.5f, Vec3f::UnitX()));
    state.frames().push_back(bus::encode_frame_pose(2, {Vec3f(0.01f, 0.0f, 0.0f), quarter}));
    ASSERT_TRUE(view_.apply(state));
    view_.update();
    const Vec3f expected = quarter * (rest - scene_.rest_centres[2]) + Vec3f(0.01f, 0.0f, 0.0f);
    // A component is rounded to 1/65534; at 17 mm from the centre that moves a point by under 1 um.
    EXPECT_LT((tongue().vertices().front().position - expected).norm(), 1e-6f);
    EXPECT_EQ(view_.surfaces().at("spine").revision(), before) << "its frame did not move";
}

TEST_F(SceneViewTest, RepeatedStateChangesNoRevision) {
    view_.apply(synthetic::deformation(scene_, 2'000'000, 0.004f, 0.01f));
    view_.update();
    const std::uint64_t tongue = view_.surfaces().at("tongue").revision(), tube = view_.tube()->revision();
    ASSERT_TRUE(view_.apply(synthetic::deformation(scene_, 3'000'000, 0.004f, 0.01f)));
    view_.update();
    EXPECT_EQ(view_.surfaces().at("tongue").revision(), tongue);
    EXPECT_EQ(view_.tube()->revision(), tube);
    // A late message of another shape is still rejected.
    view_.apply(synthetic::deformation(scene_, 2'500'000, 0.001f, 0.02f));
    view_.update();
    EXPECT_EQ(view_.surfaces().at("tongue").revision(), tongue);
    EXPECT_EQ(view_.tube()->revision(), tube);
}

TEST_F(SceneViewTest, OlderChunkDoesNotOverwriteNewerOne) {
    view_.apply(synthetic::deformation(scene_, 900'000'000, 0.005f, 0.0f));
    EXPECT_TRUE(view_.apply(synthetic::deformation(scene_, 890'000'000, 0.001f, 0.0f)));
    EXPECT_NEAR(view_.frames()[2].centre.y(), scene_.rest_centres[2].y() - 0.005f, 1e-7f);
    EXPECT_EQ(view_.simulation_time_ns(), 900'000'000u);
}

TEST_F(SceneViewTest, FollowsSessionRestart) {
    view_.apply(synthetic::deformation(scene_, 60'000'000'000, 0.005f, 0.0f));
    view_.apply(synthetic::deformation(scene_, 10'000'000, 0.001f, 0.0f));
    EXPECT_NEAR(view_.frames()[2].centre.y(), scene_.rest_centres[2].y() - 0.001f, 1e-7f);
    EXPECT_EQ(view_.simulation_time_ns(), 10'000'000u);
}

TEST_F(SceneViewTest, DeformationBeforeSceneIsHarmless) {
    view::SceneView view;
    EXPECT_TRUE(view.apply(synthetic::deformation(scene_, 1, 0.0f, 0.0f)));
    view.update();
    EXPECT_EQ(view.dropped(), 0u);
    EXPECT_EQ(view.tube(), nullptr);
}

class LiquidView : public SceneViewTest {
  protected:
    /// Chunk `which` of `particles` particles that all lie at `height` [m].
    [[nodiscard]] static msg::FluidState chunk(std::size_t which, std::size_t particles, float height,
                                               std::uint64_t time_ns) {
        const std::vector<Vec3f> positions(particles, Vec3f(0.0f, 0.0f, height));
        msg::FluidState message;
        message.header().simulation_time_ns(time_ns);
        bus::encode_fluid_chunk({Vec3f::Constant(-0.1f), Vec3f::Constant(0.1f), 0.7e-3f, positions}, which,
                                message);
        return message;
    }
};

TEST_F(LiquidView, LostChunkKeepsItsPreviousParticles) {
    const std::size_t all = bus::fluid_chunk_particles + 10;
    EXPECT_TRUE(view_.liquid().empty());
    ASSERT_TRUE(view_.apply(chunk(1, all, 0.01f, 4'000'000)));
    ASSERT_TRUE(view_.apply(chunk(0, all, 0.01f, 4'000'000)));
    view_.update();
    ASSERT_EQ(view_.liquid().size(), all);
    EXPECT_FLOAT_EQ(view_.liquid_spacing(), 0.7e-3f);
    // Only the second chunk of the next state arrives, and then a late one.
    ASSERT_TRUE(view_.apply(chunk(1, all, 0.02f, 5'000'000)));
    ASSERT_TRUE(view_.apply(chunk(1, all, 0.01f, 4'500'000)));
    view_.update();
    ASSERT_EQ(view_.liquid().size(), all);
    // Within half a 65535th of 0.2 m.
    EXPECT_NEAR(view_.liquid().front().z(), 0.01f, 1.6e-6f);
    EXPECT_NEAR(view_.liquid().back().z(), 0.02f, 1.6e-6f);
    // Removed by suction.
    ASSERT_TRUE(view_.apply(chunk(0, 0, 0.0f, 6'000'000)));
    view_.update();
    EXPECT_TRUE(view_.liquid().empty());
}

TEST_F(LiquidView, HostileChunksAreDroppedAndCounted) {
    auto message = chunk(0, 10, 0.01f, 4'000'000);
    message.chunks(65535);
    expect_refused(view_.apply(message));
    message = chunk(0, 10, 0.01f, 4'000'000);
    message.upper().x(not_a_number);
    expect_refused(view_.apply(message));
    view_.update();
    EXPECT_TRUE(view_.liquid().empty());
}

TEST_F(SceneViewTest, HostileDeformationIsDroppedAndCounted) {
    auto good = [&] { return synthetic::deformation(scene_, 3'000'000, 0.001f, 0.0f); };
    auto state = good();
    state.frames()[1].frame(4);
    expect_refused(view_.apply(state));
    state = good();
    state.frames()[1].frame(65535);
    expect_refused(view_.apply(state));
    state = good();
    state.frames()[0].x(not_a_number);
    expect_refused(view_.apply(state));
    state = good();
    state.frames()[0].y(std::numeric_limits<float>::infinity());
    expect_refused(view_.apply(state));
    state = good();
    state.frames()[0].qw(0);
    expect_refused(view_.apply(state));
    state = good();
    state.frames()[0].qx(32767);
    expect_refused(view_.apply(state));
    state = good();
    state.chunk(7);
    expect_refused(view_.apply(state));
    state = good();
    state.chunks(0);
    expect_refused(view_.apply(state));
    state = good();
    state.tube_nodes()[3].z(1e30f);
    expect_refused(view_.apply(state));
    state = good();
    state.tube_nodes().resize(1);
    expect_refused(view_.apply(state));
    EXPECT_NEAR(view_.frames()[2].centre.y(), scene_.rest_centres[2].y() - 0.003f, 1e-7f)
        << "nothing was taken";
}

TEST_F(SceneViewTest, HostileSceneIsDroppedAndCounted) {
    const msg::SceneDescription& body = scene_.objects[1];
    auto object = body;
    object.triangles()[5] = static_cast<std::uint32_t>(body.vertices().size() / 3);
    expect_refused(view_.apply(object));
    object = body;
    object.vertices().pop_back();
    expect_refused(view_.apply(object));
    object = body;
    object.vertices()[7] = not_a_number;
    expect_refused(view_.apply(object));
    object = body;
    object.skin_frame()[0] = 4;
    expect_refused(view_.apply(object));
    object = body;
    object.skin_weight().resize(8);
    expect_refused(view_.apply(object));
    object = body;
    object.skin_weight()[0] = 0;
    expect_refused(view_.apply(object));
    object = body;
    object.triangle_tissue().pop_back();
    expect_refused(view_.apply(object));
    object = body;
    object.triangle_tissue()[0] = 200;
    expect_refused(view_.apply(object));
    object = body;
    object.tissue(static_cast<std::uint8_t>(tissue_count));
    expect_refused(view_.apply(object));
    object = body;
    object.object_count(0);
    expect_refused(view_.apply(object));
    object = body;
    object.vertices().clear();
    expect_refused(view_.apply(object));
    auto description = scene_.description;
    description.landmarks()[0].name("nowhere");
    expect_refused(view_.apply(description));
    description = scene_.description;
    description.tube_inner_diameter(0.006f);
    expect_refused(view_.apply(description));
    description = scene_.description;
    description.laryngoscope().pop_back();
    expect_refused(view_.apply(description));
    description = scene_.description;
    description.scenario("term\x1b[2J");
    expect_refused(view_.apply(description));
    EXPECT_TRUE(view_.complete()) << "what was there stays";
}

TEST_F(SceneViewTest, MismatchedFrameCountIsDetected) {
    auto frames = scene_.objects.front();
    frames.vertices().resize(6);  // two frames; tongue and epiglottis need four
    EXPECT_TRUE(view_.apply(frames));
    EXPECT_EQ(view_.dropped(), 2u);
    EXPECT_FALSE(view_.complete());
    view_.update();
}

TEST_F(SceneViewTest, HostileToolAndSessionStateIsDropped) {
    auto proxy = synthetic::proxy(scene_, 5);
    proxy.proxy().position().x(not_a_number);
    expect_refused(view_.apply(proxy));
    proxy = synthetic::proxy(scene_, 5);
    proxy.proxy().orientation().w(5.0f);
    expect_refused(view_.apply(proxy));
    proxy = synthetic::proxy(scene_, 5);
    proxy.contacts().emplace_back().position().y(not_a_number);
    expect_refused(view_.apply(proxy));
    proxy.contacts()[0].position().y(0.0f);
    proxy.contacts()[0].force(not_a_number);
    expect_refused(view_.apply(proxy));
    auto live = synthetic::metrics(scene_, 5, 10.0f);
    live.landmarks().pop_back();
    expect_refused(view_.apply(live));
    live = synthetic::metrics(scene_, 5, 10.0f);
    live.landmarks()[2].y(not_a_number);
    expect_refused(view_.apply(live));
    live = synthetic::metrics(scene_, 5, 10.0f);
    live.live()[2] = not_a_number;
    expect_refused(view_.apply(live));
    live = synthetic::metrics(scene_, 5, 10.0f);
    live.glottis_contour().emplace_back().z(not_a_number);
    expect_refused(view_.apply(live));
    live = synthetic::metrics(scene_, 5, not_a_number);
    expect_refused(view_.apply(live));
    auto status = synthetic::status(msg::PHASE_RUNNING);
    status.load(not_a_number);
    expect_refused(view_.apply(status));
    live = synthetic::metrics(scene_, 5, 10.0f);
    live.message("two\nlines");
    expect_refused(view_.apply(live));
}

TEST_F(SceneViewTest, KeepsNewestAttemptAndRunSummary) {
    EXPECT_FALSE(view_.attempt_report());
    ASSERT_TRUE(view_.apply(synthetic::summary(2, true, 30'000'000'000)));
    // A late joiner receives all of them, in any order.
    ASSERT_TRUE(view_.apply(synthetic::summary(1, false, 10'000'000'000)));
    ASSERT_TRUE(view_.apply(synthetic::summary(0, true, 31'000'000'000)));
    ASSERT_TRUE(view_.attempt_report());
    EXPECT_EQ(view_.attempt_report()->attempt, 2u);
    EXPECT_TRUE(view_.attempt_report()->outcome.success);
    EXPECT_EQ(view_.attempt_report()->outcome.reason, "the tube lies in the trachea");
    EXPECT_EQ(view_.attempt_report()->metrics.gum_force_mean_n, 1.0);
    EXPECT_TRUE(std::isnan(view_.attempt_report()->metrics.tube_speed_max_cm_per_s));
    ASSERT_TRUE(view_.run_report());
    // A restarted run has none.
    view_.apply(synthetic::deformation(scene_, 60'000'000'000, 0.0f, 0.0f));
    view_.apply(synthetic::deformation(scene_, 10'000'000, 0.0f, 0.0f));
    EXPECT_FALSE(view_.attempt_report());
    EXPECT_FALSE(view_.run_report());
}

TEST_F(SceneViewTest, HostileSummariesAreDropped) {
    auto summary = synthetic::summary(1, true, 5);
    summary.parameters()[3] = std::numeric_limits<double>::infinity();
    expect_refused(view_.apply(summary));
    summary = synthetic::summary(1, true, 5);
    summary.reason("\x07");
    expect_refused(view_.apply(summary));
    EXPECT_FALSE(view_.attempt_report());
}

TEST_F(SceneViewTest, SceneOfDifferentSizeReplacesOldOne) {
    auto frames = scene_.objects.front();
    frames.object_count(1);
    EXPECT_TRUE(view_.apply(frames));
    EXPECT_TRUE(view_.complete());
    EXPECT_TRUE(view_.surfaces().empty());
    view_.update();
}

}  // namespace
}  // namespace eti
