// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/annotations.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "client/view/displaced_vertices.hpp"
#include "synthetic_scene.hpp"

namespace eti::view {
namespace {

msg::ShownAnnotation point(std::uint32_t slot, std::uint32_t triangle, float u = 0.2f) {
    msg::ShownAnnotation shown;
    shown.slot(slot);
    shown.what().kind(msg::ANNOTATION_POINT);
    shown.what().sender("desk:7");
    shown.what().object("tongue");
    msg::SurfacePlace& place = shown.what().places().emplace_back();
    place.triangle(triangle);
    place.u(u);
    place.v(0.3f);
    place.height(0.5e-3f);
    return shown;
}

class SceneAnnotations : public ::testing::Test {
  protected:
    void SetUp() override { synthetic::fill(scene_, source_); }

    synthetic::Scene source_ = synthetic::make_scene();
    SceneView scene_;
};

TEST_F(SceneAnnotations, StayUntilSlotIsClearedOrReused) {
    ASSERT_TRUE(scene_.apply(point(3, 5)));
    ASSERT_TRUE(scene_.apply(point(4, 6)));
    EXPECT_EQ(scene_.annotations().size(), 2u);
    ASSERT_TRUE(scene_.apply(point(3, 7)));
    EXPECT_EQ(scene_.annotations().at(3).places.at(0).triangle, 7u);
    msg::ShownAnnotation wiped;
    wiped.slot(3);
    wiped.what().kind(msg::ANNOTATION_CLEAR);
    ASSERT_TRUE(scene_.apply(wiped));
    EXPECT_EQ(scene_.annotations().size(), 1u);
}

TEST_F(SceneAnnotations, AreClearedOnSessionRestart) {
    ASSERT_TRUE(scene_.apply(synthetic::deformation(source_, 5'000'000'000, 0.0f, 0.0f)));
    ASSERT_TRUE(scene_.apply(point(0, 5)));
    ASSERT_TRUE(scene_.apply(synthetic::deformation(source_, 1'000'000, 0.0f, 0.0f)));
    EXPECT_TRUE(scene_.annotations().empty());
}

// From a server that nothing authenticates.
TEST_F(SceneAnnotations, InvalidMessagesAreRejected) {
    auto beside = point(0, 1);
    beside.what().places().emplace_back(beside.what().places().front());
    auto broken = point(0, 1);
    broken.what().text("a\nb");
    auto short_stroke = point(0, 1);
    short_stroke.what().kind(msg::ANNOTATION_STROKE);
    const std::uint64_t before = scene_.dropped();
    for (const msg::ShownAnnotation& one :
         {point(256, 1), point(0, 1, std::numeric_limits<float>::quiet_NaN()), point(0, 1, 1.2f), beside,
          broken, short_stroke}) {
        EXPECT_FALSE(scene_.apply(one));
    }
    EXPECT_EQ(scene_.dropped(), before + 6);
    EXPECT_TRUE(scene_.annotations().empty());
    // Annotations on an object or triangle missing from the scene are not drawn; the scene may still be
    // incomplete.
    EXPECT_FALSE(current_position(scene_, "moon", {}));
    EXPECT_FALSE(current_position(scene_, "tongue", {.triangle = 10'000'000}));
}

// Against the surface as skinned and displaced for the picture.
TEST_F(SceneAnnotations, FollowDeformedTissue) {
    Vec3f before = Vec3f::Zero();
    for (const float lift : {0.0f, 0.004f}) {
        ASSERT_TRUE(scene_.apply(synthetic::deformation(
            source_, 2'000'000 + static_cast<std::uint64_t>(1e9f * lift), lift, 0.0f)));
        scene_.update();
        const SkinnedSurface& tongue = scene_.surfaces().at("tongue");
        const auto vertices = displaced_vertices(scene_, tongue);
        for (const std::uint32_t t : {0u, 40u, 200u}) {
            const SurfacePlace place{t, 0.2f, 0.3f, 0.5e-3f};
            const auto& [a, b, c] = tongue.model().mesh.triangles.at(t);
            const auto where = current_position(scene_, "tongue", place);
            ASSERT_TRUE(where);
            EXPECT_LT(
                (*where - point_at(place, vertices[a].position, vertices[b].position, vertices[c].position))
                    .norm(),
                1e-6f);
        }
        const Vec3f now = *current_position(scene_, "tongue", {200, 0.2f, 0.3f, 0.0f});
        EXPECT_TRUE(lift == 0.0f || (now - before).norm() > 1e-3f);
        before = now;
    }
    const auto on_blade = current_position(scene_, bus::laryngoscope_object, {0, 0.0f, 0.0f, 0.0f});
    const TriangleMesh& blade = *scene_.laryngoscope();
    ASSERT_TRUE(on_blade);
    EXPECT_LT((*on_blade - *scene_.laryngoscope_pose() * blade.vertices[blade.triangles[0][0]]).norm(),
              1e-6f);
}

TEST_F(SceneAnnotations, TraineeEyeIsReceived) {
    EXPECT_FALSE(scene_.trainee_eye());
    auto metrics = synthetic::metrics(source_, 2'000'000, 40.0f);
    metrics.eye_heard(true);
    metrics.eye().position().z(0.3f);
    metrics.eye().orientation().w(1.0f);
    ASSERT_TRUE(scene_.apply(metrics));
    ASSERT_TRUE(scene_.trainee_eye());
    EXPECT_EQ(scene_.trainee_eye()->translation, Vec3f(0.0f, 0.0f, 0.3f));
    metrics.eye().position().z(std::numeric_limits<float>::infinity());
    EXPECT_FALSE(scene_.apply(metrics));
    metrics.eye_heard(false);
    ASSERT_TRUE(scene_.apply(metrics));
    EXPECT_FALSE(scene_.trainee_eye());
}

}  // namespace
}  // namespace eti::view
