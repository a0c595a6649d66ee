// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/view/line_of_sight.hpp"

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
    // Level with the gum's crest, in the mouth's cavity.
    Vec3f mouth_ = at(source_.landmarks, Landmark::upper_gum) + Vec3f(0.0f, 0.004f, -0.004f);
};

TEST_F(LineOfSight, GoesFromTheEyeToTheGlottis) {
    const view::TraineeEye eye(Vec3f(0.01f, 0.0f, 0.0f));
    const view::Sight sight = view::sight_of(eye, source_.landmarks);
    EXPECT_EQ(sight.from, eye.position(source_.landmarks));
    EXPECT_EQ(sight.to, at(source_.landmarks, Landmark::glottis));
}

TEST_F(LineOfSight, NamesWhatItMeetsFirstAndWhere) {
    // Along z through the tongue's middle: an ellipsoid about (0, 0.016, -0.002) whose half axis is 7 mm.
    const Vec3f centre(0.0f, 0.016f, -0.002f);
    const auto met =
        view::obstacle(bare_, {centre + Vec3f(0.0f, 0.0f, 0.015f), centre - Vec3f(0.0f, 0.0f, 0.015f)});
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "tongue");
    // Facets of 1 mm on a radius of curvature of 11 mm lie at most 0.05 mm inside.
    EXPECT_NEAR(met->where.z(), 0.005f, 1e-4f);
    EXPECT_NEAR(met->where.y(), centre.y(), 1e-6f);
}

TEST_F(LineOfSight, FreeAirHidesNothing) {
    EXPECT_FALSE(view::obstacle(bare_, {Vec3f(0.2f, 0.0f, 0.0f), Vec3f(0.2f, 0.1f, 0.1f)}));
}

TEST_F(LineOfSight, ABladeInTheWayIsNamed) {
    // Across the blade, 3 cm short of its tip, in the throat's cavity.
    const RigidTransform& pose = *held_.laryngoscope_pose();
    const Vec3f middle = pose * Vec3f(0.0f, 0.0f, 0.05f);
    const Vec3f across = pose.rotation * Vec3f(0.006f, 0.0f, 0.0f);
    const auto met = view::obstacle(held_, {middle + across, middle - across});
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "blade");
    // Its radius is 3 mm, in cells of 2 mm.
    EXPECT_NEAR((met->where - middle).norm(), 0.003f, 5e-4f);
}

TEST_F(LineOfSight, ATubeInTheWayIsNamed) {
    // Across it, outside the mouth.
    const auto nodes = held_.tube_nodes();
    const Vec3f middle = nodes[2];
    const float radius = held_.tube()->tube().outer_radius();
    const Vec3f aside(2.0f * radius, 0.0f, 0.0f);
    const auto met = view::obstacle(held_, {middle + aside, middle});
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "tube");
}

TEST_F(LineOfSight, LipsAreHeldAsideForIt) {
    // Down to the mouth's cavity, level with the gum, nothing is met.
    const view::TraineeEye eye;
    EXPECT_FALSE(view::obstacle(bare_, {eye.position(source_.landmarks), mouth_}));
    // An eye moved far aside looks through the cheek, which no finger holds.
    const view::TraineeEye aside(Vec3f(0.25f, 0.0f, 0.0f));
    const auto met = view::obstacle(bare_, view::sight_of(aside, source_.landmarks));
    ASSERT_TRUE(met);
    EXPECT_EQ(met->name, "soft tissue");
}

}  // namespace
}  // namespace eti
