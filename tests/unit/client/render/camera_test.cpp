// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "client/render/view_table.hpp"
#include "synthetic_scene.hpp"

namespace eti::render {
namespace {

// In the patient frame the world's vertical turns against the table: head-up by an angle, it leans towards
// the head (+z) by as much.
TEST(OverviewCamera, KeepsTheWorldsVerticalOnATiltedTable) {
    Landmarks rest;
    rest.fill(Vec3f::Zero());
    const Orbit orbit;
    const Camera level = overview_camera(rest, orbit);
    const float angle = 15.0f * degree;
    const Camera tilted = overview_camera(rest, orbit, angle);
    const Vec3f vertical(0.0f, -std::cos(angle), std::sin(angle));
    EXPECT_LT((level.up - Vec3f(0.0f, -1.0f, 0.0f)).norm(), 1e-6f);
    EXPECT_LT((tilted.up - vertical).norm(), 1e-6f);
    // The onlooker stands as high and as far as before.
    EXPECT_NEAR((tilted.eye - tilted.target).dot(vertical), (level.eye - level.target).dot(level.up), 1e-6f);
    EXPECT_NEAR((tilted.eye - tilted.target).norm(), (level.eye - level.target).norm(), 1e-6f);
    EXPECT_EQ(tilted.target, level.target);
}

// What is published as the trainee's eye is what its pictures are drawn from.
TEST(EyeCamera, IsThePublishedEyeWithANaturalField) {
    const synthetic::Scene source = synthetic::make_scene();
    view::SceneView scene;
    synthetic::fill(scene, source);
    const View* const eye = view_named("eye");
    ASSERT_NE(eye, nullptr);
    const Vantage from{.eye = view::TraineeEye(Vec3f(0.01f, -0.02f, 0.0f))};
    const Camera camera = eye->camera(scene, from);
    const RigidTransform published = from.eye.pose(source.landmarks);
    EXPECT_LT((camera.pose().translation - published.translation).norm(), 1e-6f);
    EXPECT_LT(camera.pose().rotation.angularDistance(published.rotation), 1e-3f);
    // At arm's length, 0.3 m from the gum, the picture holds a head of 10 cm twice.
    const float distance = (camera.eye - at(source.landmarks, Landmark::upper_gum)).norm();
    EXPECT_NEAR(2.0f * distance * std::tan(0.5f * camera.vertical_field), 0.22f, 0.02f);
}

}  // namespace
}  // namespace eti::render
