// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/hand.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene_picture.hpp"

namespace eti {
namespace {

using render::Grip;
using LarynxHand = test::ScenePicture;

// Thumb and index beside the larynx, whose front stays free between them; in the frame of the grip.
TEST(Hand, AssistantsFingersFlankTheLarynx) {
    const auto free = [](const Vec3f& place) { return render::hand_distance(Grip::larynx, place); };
    EXPECT_LT(free({-12e-3f, -8e-3f, 0}), 0.0f) << "thumb";
    EXPECT_LT(free({12e-3f, -8e-3f, 0}), 0.0f) << "index";
    EXPECT_GT(free({0, -8e-3f, 0}), 3e-3f) << "the larynx between them";
}

TEST(Hand, AssistantsWristIsAwayFromTheOperator) {
    const RigidTransform pose = render::larynx_grip(Vec3f::Zero());
    const Vec3f wrist = pose * Vec3f(0.0f, 0.168f, 0.027f);
    EXPECT_GT(wrist.x(), 0.05f) << "on the patient's left";
    EXPECT_LT(wrist.z(), -0.03f) << "caudal: the operator stands at the head";
    EXPECT_LT(wrist.y(), -0.05f) << "above the patient, who lies on the back";
}

TEST_F(LarynxHand, AppearsOnlyWhilePressed) {
    const auto hands = [&](float newtons) {
        view::SceneView scene = scene_;
        msg::LiveMetrics metrics = synthetic::metrics(source_, scene.simulation_time_ns(), 50.0f);
        RuntimeParameters live = scene.live();
        live.laryngeal_pressure_back = newtons;
        bus::set_runtime_parameters(live, metrics);
        EXPECT_TRUE(scene.apply(metrics));
        scene.update();
        renderer_.sync(scene);
        return renderer_.meshes().room().hands().size();
    };
    const std::size_t without = hands(0.0f);
    EXPECT_EQ(hands(3.0f), without + 1);
    EXPECT_EQ(hands(0.0f), without);
}

}  // namespace
}  // namespace eti
