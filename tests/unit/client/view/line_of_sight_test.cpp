// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/sight/line_of_sight.hpp"

#include <gtest/gtest.h>

#include "synthetic_scene.hpp"

namespace eti {
namespace {

class LineOfSight : public ::testing::Test {
  protected:
    void SetUp() override {
        bare_.apply(source_.description);
        for (const auto& object : source_.objects) {
            bare_.apply(object);
        }
        bare_.update();
        synthetic::fill(held_, source_);
    }

    synthetic::Scene source_ = synthetic::make_scene();
    view::SceneView bare_;  // nothing lifted, no tools
    view::SceneView held_;  // with blade
    // Level with the gum's crest, in the oral cavity.
    Vec3f mouth_ = at(source_.landmarks, Landmark::upper_gum) + Vec3f(0.0f, 0.004f, -0.004f);
};

TEST_F(LineOfSight, RunsFromEyeToGlottis) {
    const view::TraineeEye eye(Vec3f(0.01f, 0.0f, 0.0f));
    const view::SightLine sight = view::sight_line(eye, source_.landmarks);
    EXPECT_EQ(sight.from, eye.position(source_.landmarks));
    EXPECT_EQ(sight.to, at(source_.landmarks, Landmark::glottis));
}

TEST_F(LineOfSight, FindsFirstObstacleAndItsPosition) {
    // Along z through the tongue's middle: an ellipsoid about (0, 0.016, -0.002) whose half axis is 7 mm.
    const Vec3f centre(0.0f, 0.016f, -0.002f);
    const auto met =
        view::find_obstacle(bare_, {centre + Vec3f(0.0f, 0.0f, 0.015f), centre - Vec3f(0.0f, 0.0f, 0.015f)});
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "tongue");
    // Facets of 1 mm on a radius of curvature of 11 mm lie at most 0.05 mm inside.
    EXPECT_NEAR(met->position.z(), 0.005f, 1e-4f);
    EXPECT_NEAR(met->position.y(), centre.y(), 1e-6f);
}

TEST_F(LineOfSight, GrazesTongueWithinHalfAMillimetre) {
    // Level lines across the tongue's middle, whose top lies at z = 5 mm; facets lie at most 0.05 mm inside.
    const auto across = [&](float z) {
        return view::find_obstacle(bare_, {Vec3f(-0.003f, 0.016f, z), Vec3f(0.003f, 0.016f, z)});
    };
    ASSERT_TRUE(across(0.0046f));
    EXPECT_EQ(across(0.0046f)->name, "tongue");
    EXPECT_FALSE(across(0.0054f));
}

TEST_F(LineOfSight, NamesOccludingBlade) {
    // Across the blade, 3 cm short of its tip, in the throat's cavity.
    const RigidTransform& pose = *held_.laryngoscope_pose();
    const Vec3f middle = pose * Vec3f(0.0f, 0.0f, 0.05f);
    const Vec3f across = pose.rotation * Vec3f(0.006f, 0.0f, 0.0f);
    const auto met = view::find_obstacle(held_, {middle + across, middle - across});
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "blade");
    // Its radius is 3 mm, in cells of 2 mm.
    EXPECT_NEAR((met->position - middle).norm(), 0.003f, 5e-4f);
}

TEST_F(LineOfSight, NamesOccludingTube) {
    // Across it, outside the mouth.
    const auto nodes = held_.tube_nodes();
    const Vec3f middle = nodes[2];
    const float radius = held_.tube()->tube().outer_radius();
    const Vec3f aside(2.0f * radius, 0.0f, 0.0f);
    const auto met = view::find_obstacle(held_, {middle + aside, middle});
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "tube");
}

TEST_F(LineOfSight, PassesRetractedLips) {
    // The ray to the oral cavity, level with the gum, hits nothing.
    const view::TraineeEye eye;
    EXPECT_FALSE(view::find_obstacle(bare_, {eye.position(source_.landmarks), mouth_}));
    // An eye far to the side looks through the cheek, which no finger retracts.
    const view::TraineeEye aside(Vec3f(0.25f, 0.0f, 0.0f));
    const auto met = view::find_obstacle(bare_, view::sight_line(aside, source_.landmarks));
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "soft tissue");
}

}  // namespace
}  // namespace eti
