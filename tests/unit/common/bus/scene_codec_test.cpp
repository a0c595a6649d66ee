// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include "common/bus/codec/annotation.hpp"
#include "common/bus/codec/attempt_report.hpp"
#include "common/bus/codec/frame_pose.hpp"
#include "common/bus/codec/scene_object.hpp"
#include "tests/support/session_description.hpp"

namespace eti::bus {
namespace {

Surface triangle() {
    Surface surface{"tongue", Tissue::tongue, {}, {Tissue::soft}, {}};
    surface.mesh.vertices = {{0, 0, 0}, {0.02f, 0, 0}, {0, 0.02f, 0}};
    surface.mesh.triangles = {{0, 1, 2}};
    surface.skin.assign(3, {{4, 7}, {0.25f, 0.75f}});
    return surface;
}

TEST(SceneCodec, SurfaceSurvivesRoundTrip) {
    const Surface sent = triangle();
    std::string why;
    const auto object = decode_scene_object(encode_surface(sent), why);
    ASSERT_TRUE(object) << why;
    const auto& got = std::get<RestSurface>(*object);
    EXPECT_EQ(got.name, sent.name);
    EXPECT_EQ(got.tissue, sent.tissue);
    EXPECT_EQ(got.mesh.vertices, sent.mesh.vertices);
    EXPECT_EQ(got.mesh.triangles, sent.mesh.triangles);
    EXPECT_EQ(got.triangle_tissue, sent.triangle_tissue);
    EXPECT_EQ(got.highest_frame, 7);
    for (const SkinWeights& skin : got.skin) {
        EXPECT_EQ(skin.frame, sent.skin[0].frame);
        EXPECT_NEAR(skin.weight[1], 0.75f, 0.5f / 65535.0f);
    }
}

TEST(SceneCodec, FramesAndBladeSurviveRoundTrip) {
    const std::vector<Vec3f> centres{{0.1f, 0.2f, 0.3f}, {0, 0, 1}};
    std::string why;
    const auto frames = decode_scene_object(encode_frames(centres), why);
    ASSERT_TRUE(frames) << why;
    EXPECT_EQ(std::get<std::vector<Vec3f>>(*frames), centres);
    const TriangleMesh mesh = triangle().mesh;
    const auto blade = decode_scene_object(encode_laryngoscope(mesh), why);
    ASSERT_TRUE(blade) << why;
    EXPECT_EQ(std::get<TriangleMesh>(*blade).vertices, mesh.vertices);
}

TEST(SceneCodec, FramePoseIsExactToItsQuantum) {
    const FramePose sent{{0.01f, -0.2f, 0.3f}, quaternion_from({0.3f, -1.2f, 0.9f})};
    const msg::FrameUpdate update = encode_frame_pose(300, sent);
    EXPECT_EQ(update.frame(), 300);
    const auto got = decode_frame_pose(update);
    ASSERT_TRUE(got);
    EXPECT_EQ(got->centre, sent.centre);
    // Half a quantum in each of four components, and as much again by normalising.
    EXPECT_LT((got->rotation.coeffs() - sent.rotation.coeffs()).norm(), 2.0f / quaternion_unit);
    msg::FrameUpdate hostile = update;
    hostile.qw(0);
    EXPECT_FALSE(decode_frame_pose(hostile));
    hostile = update;
    hostile.x(max_coordinate);
    EXPECT_FALSE(decode_frame_pose(hostile));
}

TEST(SceneCodec, AnnotationSurvivesRoundTrip) {
    const Annotation sent{
        5, msg::ANNOTATION_STROKE, "a", "b", "tongue", {{1, 0.1f, 0.2f, 0}, {2, 0, 0.5f, 0.01f}}};
    msg::ShownAnnotation message;
    message.header().simulation_time_ns(sent.time_ns);
    message.what(encode_annotation(sent));
    std::string why;
    const auto got = decode_annotation(message, why);
    ASSERT_TRUE(got) << why;
    EXPECT_EQ(got->time_ns, sent.time_ns);
    EXPECT_EQ(got->kind, sent.kind);
    EXPECT_EQ(got->sender + got->text + got->object, "abtongue");
    EXPECT_EQ(got->places, sent.places);
}

TEST(SceneCodec, AttemptReportSurvivesRoundTrip) {
    std::string why;
    const auto keys =
        SessionKeys::of(test::session_description(zero_landmarks(), make_laryngoscope(Blade::miller_0)), why);
    ASSERT_TRUE(keys) << why;
    AttemptReport sent{3, 7, {true, "the tube lies in the trachea"}, initial_metrics()};
    sent.metrics.time_s = 12.5;
    const auto got = decode_attempt(encode_attempt(sent, 1), *keys, why);
    ASSERT_TRUE(got) << why;
    EXPECT_EQ(got->attempt, sent.attempt);
    EXPECT_EQ(got->ended_ns, sent.ended_ns);
    EXPECT_EQ(got->outcome.reason, sent.outcome.reason);
    EXPECT_EQ(got->metrics.time_s, sent.metrics.time_s);
}

}  // namespace
}  // namespace eti::bus
