// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hands/picture_plane.hpp"

#include <gtest/gtest.h>

namespace eti {
namespace {

constexpr float width = 960.0f, height = 540.0f;

render::Camera camera() {
    render::Camera out;
    out.eye = {0.3f, -0.2f, 0.25f};
    out.target = {0.01f, 0.02f, -0.04f};
    return out;
}

// Pixels from the upper left, by the matrices used for drawing.
Eigen::Vector2f pixel_of(const render::Camera& from, const Vec3f& point) {
    const Eigen::Vector4f clip = from.projection(width / height) * from.view() * point.homogeneous();
    return {0.5f * width * (1.0f + clip.x() / clip.w()), 0.5f * height * (1.0f - clip.y() / clip.w())};
}

TEST(PicturePlane, DraggedPointStaysUnderPointer) {
    const render::Camera from = camera();
    const Vec3f point(0.02f, -0.01f, 0.01f);
    const Vec3f way = hands::picture_displacement(from, height, point, 37.0f, -21.0f);
    const Eigen::Vector2f moved = pixel_of(from, point + way) - pixel_of(from, point);
    // Float matrices of a scene of a metre: 1e-6 of 960 pixels, with a margin.
    EXPECT_NEAR(moved.x(), 37.0f, 0.01f);
    EXPECT_NEAR(moved.y(), -21.0f, 0.01f);
    EXPECT_NEAR(way.dot((from.target - from.eye).normalized()), 0.0f, 1e-6f) << "in the picture's plane";
}

TEST(PicturePlane, PointBehindLensMovesAsAt10Millimetres) {
    const render::Camera from = camera();
    const Vec3f gaze = (from.target - from.eye).normalized();
    const Vec3f near = hands::picture_displacement(from, height, from.eye + 0.01f * gaze, 10.0f, 0.0f);
    EXPECT_GT(near.norm(), 0.0f);
    EXPECT_NEAR(
        (hands::picture_displacement(from, height, from.eye - 0.05f * gaze, 10.0f, 0.0f) - near).norm(), 0.0f,
        1e-7f);
}

}  // namespace
}  // namespace eti
