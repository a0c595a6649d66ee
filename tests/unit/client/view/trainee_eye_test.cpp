// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/trainee_eye.hpp"

#include <gtest/gtest.h>

#include "synthetic_scene.hpp"

namespace eti::view {
namespace {

const Landmarks points = synthetic::make_scene().landmarks;

Vec3f gaze(const TraineeEye& eye) {
    return eye.pose(points).rotation * -Vec3f::UnitZ();
}

TEST(TraineeEye, DefaultsToBestViewOfGlottis) {
    const TraineeEye eye;
    EXPECT_EQ(eye.position(points), best_eye(points));
    EXPECT_EQ(eye.pose(points).translation, best_eye(points));
    const Vec3f way = at(points, Landmark::glottis) - best_eye(points);
    EXPECT_GT(gaze(eye).dot(way.normalized()), 1.0f - 1e-6f);
    // The tongue's side is up.
    EXPECT_LT((eye.pose(points).rotation * Vec3f::UnitY()).y(), 0.0f);
}

TEST(TraineeEye, OffsetIsInPatientFrameAndKeepsGaze) {
    const Vec3f offset(0.01f, -0.02f, 0.03f);
    const TraineeEye eye(offset);
    EXPECT_LT((eye.position(points) - best_eye(points) - offset).norm(), 1e-6f);
    const Vec3f way = at(points, Landmark::glottis) - eye.position(points);
    EXPECT_GT(gaze(eye).dot(way.normalized()), 1.0f - 1e-6f);
}

TEST(TraineeEye, MovesAlongItsOwnAxes) {
    const RigidTransform before = TraineeEye().pose(points);
    for (int axis = 0; axis < 3; ++axis) {
        Vec3f by = Vec3f::Zero();
        by[axis] = 0.01f;
        TraineeEye eye;
        eye.move(by, points);
        EXPECT_LT((eye.position(points) - before * by).norm(), 1e-6f) << axis;
        eye.settle();
        EXPECT_EQ(eye.position(points), best_eye(points));
    }
}

TEST(TraineeEye, IsLimitedToReachAndOutsideMouth) {
    EXPECT_EQ(TraineeEye(Vec3f(1.0f, -1.0f, 0.0f)).offset(),
              Vec3f(TraineeEye::max_offset, -TraineeEye::max_offset, 0.0f));
    TraineeEye eye;
    for (int i = 0; i < 100; ++i) {
        eye.move({0.0f, 0.0f, -0.01f}, points);
    }
    EXPECT_GE((eye.position(points) - at(points, Landmark::glottis)).norm(), TraineeEye::min_distance);
    // And back out again.
    const Vec3f near = eye.position(points);
    eye.move({0.0f, 0.0f, 0.01f}, points);
    EXPECT_GT((eye.position(points) - near).norm(), 0.009f);
}

TEST(TraineeEye, TurnsGazeInPlace) {
    TraineeEye eye;
    const RigidTransform straight = eye.pose(points);
    eye.turn(0.1f, 0.0f);
    EXPECT_NEAR((straight.inverse().rotation * gaze(eye)).x(), std::sin(0.1f), 1e-5f);
    eye.turn(-0.1f, 0.1f);
    EXPECT_NEAR((straight.inverse().rotation * gaze(eye)).y(), std::sin(0.1f), 1e-5f);
    EXPECT_EQ(eye.position(points), best_eye(points));
    eye.turn(9.0f, 9.0f);
    EXPECT_TRUE(is_valid_pose(eye.pose(points)));
    EXPECT_GT((straight.inverse().rotation * gaze(eye)).z(), -1.0f);
    EXPECT_LT((straight.inverse().rotation * gaze(eye)).z(), 0.0f) << "still towards the patient";
}

TEST(TraineeEye, WornEyeFollowsHeadPose) {
    const RigidTransform held = RigidTransform::about({0.1f, -0.3f, 0.2f}, Vec3f::UnitX(), 0.3f);
    TraineeEye eye = TraineeEye::from_headset(held);
    eye.move({0.01f, 0.01f, 0.01f}, points);
    eye.turn(0.1f, 0.1f);
    EXPECT_EQ(eye.position(points), held.translation);
    EXPECT_EQ(eye.pose(points).translation, held.translation);
    EXPECT_EQ(eye.pose(points).rotation.coeffs(), held.rotation.coeffs());
    EXPECT_EQ(eye.position(zero_landmarks()), held.translation) << "whatever the patient does";
}

TEST(TraineeEye, IsAtOriginWhileLandmarksAreMissing) {
    const RigidTransform pose = TraineeEye().pose(zero_landmarks());
    EXPECT_TRUE(is_valid_pose(pose));
    EXPECT_LT(pose.translation.norm(), 1e-6f);
}

}  // namespace
}  // namespace eti::view
