// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/views/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "client/render/views/view_table.hpp"
#include "synthetic_scene.hpp"

namespace eti::render {
namespace {

// In the patient frame the world's vertical turns against the table: head-up by an angle, it leans towards
// the head (+z) by that angle.
TEST(OverviewCamera, KeepsWorldVerticalOnTiltedTable) {
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

// The published trainee's eye is the one that its pictures are drawn from.
TEST(EyeCamera, MatchesPublishedEyeAndNaturalFieldOfView) {
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
    // At arm's length, 0.3 m from the gum, the picture holds a newborn's head, 10 cm wide, and little more.
    const float distance = (camera.eye - at(source.landmarks, Landmark::upper_gum)).norm();
    EXPECT_NEAR(2.0f * distance * std::tan(0.5f * camera.vertical_fov), 0.14f, 0.02f);
}

TEST(SectionCamera, FacesSectionPlane) {
    const Landmarks points = synthetic::make_scene().landmarks;
    for (const Section& section :
         {Section(), Section(0.01f, 0.3f, 0.2f), Section(0.0f, 0.0f, 90.0f * degree)}) {
        const CutPlane plane = section.plane(points);
        const Camera camera = section_camera(section, points, points);
        EXPECT_NEAR(plane.normal.norm(), 1.0f, 1e-6f);
        EXPECT_NEAR((camera.eye - camera.target).normalized().dot(plane.normal), 1.0f, 1e-6f);
        EXPECT_NEAR(plane.kept().dot(camera.target.homogeneous()), 0.0f, 1e-6f) << "the plane is in focus";
        EXPECT_LT(plane.kept().dot(camera.eye.homogeneous()), 0.0f) << "the eye stands where nothing is left";
        EXPECT_NEAR(camera.up.dot(plane.normal), 0.0f, 1e-6f);
    }
}

TEST(SectionCamera, FramesSmallerPatientEquallyLarge) {
    Landmarks points = synthetic::make_scene().landmarks;
    const Camera term = section_camera({}, points, points);
    for (Vec3f& point : points) {
        point *= 0.8f;
    }
    const Camera smaller = section_camera({}, points, points);
    EXPECT_NEAR(std::tan(0.5f * smaller.vertical_fov), 0.8f * std::tan(0.5f * term.vertical_fov), 1e-5f);
}

TEST(Section, DefaultsToMidlineAndIsClamped) {
    const Landmarks points = synthetic::make_scene().landmarks;
    EXPECT_EQ(Section().plane(points).normal, Vec3f(Vec3f::UnitX()));
    EXPECT_EQ(Section().plane(points).origin.x(), 0.0f);
    EXPECT_NEAR(Section(0.005f, 0.0f, 0.0f).plane(points).origin.x(), 0.005f, 1e-7f);
    EXPECT_EQ(Section(9.0f, 0.0f, 0.0f), Section(Section::max_offset, 0.0f, 0.0f));
    EXPECT_EQ(Section(0.0f, 0.0f, 9.0f), Section(0.0f, 0.0f, Section::max_tilt));
    // Turned by a quarter it cuts across: the side towards head or feet is taken away.
    EXPECT_NEAR(std::abs(Section(0.0f, 90.0f * degree, 0.0f).plane(points).normal.z()), 1.0f, 1e-6f);
    // Tilted by a quarter it separates front and back.
    EXPECT_NEAR(std::abs(Section(0.0f, 0.0f, 90.0f * degree).plane(points).normal.y()), 1.0f, 1e-6f);
}

TEST(BladeCamera, SitsNearTipLookingAlongBlade) {
    const RigidTransform pose = RigidTransform::about({0.01f, 0.02f, 0.03f}, Vec3f::UnitX(), 0.7f);
    const Camera camera = blade_camera(pose, make_laryngoscope(Blade::miller_1));
    const Vec3f tip = pose * Vec3f(0.0f, 0.0f, 0.1f);
    EXPECT_LT((camera.eye - tip).norm(), 0.02f);
    const Vec3f gaze = (camera.target - camera.eye).normalized();
    EXPECT_GT(gaze.dot(pose.rotation * Vec3f::UnitZ()), 0.95f);
    EXPECT_GT(camera.up.dot(pose.rotation * Vec3f::UnitY()), 0.95f) << "the tongue's side is up";
    // The tip is in the picture, above its middle.
    const Eigen::Vector4f clip = camera.projection(1.0f) * camera.view() * tip.homogeneous();
    EXPECT_GT(clip.w(), 0.0f);
    EXPECT_GT(clip.y(), 0.0f);
    EXPECT_LT(clip.y(), clip.w());
}

// A lens shows the field within its four angles, and its corners are those of the picture.
TEST(WornCamera, ProjectsAsymmetricFieldOfView) {
    const RigidTransform pose = RigidTransform::about({0.1f, -0.2f, 0.3f}, Vec3f::UnitY(), 0.4f);
    const FieldOfView field{-0.9f, 0.6f, 0.5f, -0.8f};
    const Camera camera = headset_camera(pose, field);
    EXPECT_LT((camera.pose().translation - pose.translation).norm(), 1e-6f);
    EXPECT_LT(camera.pose().rotation.angularDistance(pose.rotation), 1e-3f);
    for (const auto& [x, angle_x] : {std::pair{-1.0f, field.left}, std::pair{1.0f, field.right}}) {
        for (const auto& [y, angle_y] : {std::pair{-1.0f, field.down}, std::pair{1.0f, field.up}}) {
            const Vec3f corner = pose * (0.7f * Vec3f(std::tan(angle_x), std::tan(angle_y), -1.0f));
            // For any aspect ratio of the picture: the angles alone decide.
            const Eigen::Vector4f clip = camera.projection(3.0f) * camera.view() * corner.homogeneous();
            EXPECT_NEAR(clip.x() / clip.w(), x, 1e-4f);
            EXPECT_NEAR(clip.y() / clip.w(), y, 1e-4f);
        }
    }
}

}  // namespace
}  // namespace eti::render
