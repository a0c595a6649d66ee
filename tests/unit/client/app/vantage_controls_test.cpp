// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/window/vantage_controls.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "client/app/controls.hpp"
#include "client/app/window/command_keys.hpp"
#include "client/app/window/compositor.hpp"
#include "synthetic_scene.hpp"

namespace eti {
namespace {

using hands::Drag;
using render::Vantage;

const Landmarks points = synthetic::make_scene().landmarks;

// Displacement of the eye from its initial position, along its own axes.
Vec3f went(const Vantage& vantage) {
    return view::TraineeEye().pose(points).inverse() * vantage.eye.position(points);
}

TEST(VantageKeys, DoNotCollideWithOtherKeys) {
    std::set<char32_t> keys{U'h', U'?'};
    for (const client::Selection& one : client::selections()) {
        keys.insert(static_cast<char32_t>(one.key));
    }
    for (const client::CommandKey& key : client::command_keys()) {
        keys.insert(key.key);
    }
    for (const client::VantageKey& key : client::vantage_keys()) {
        EXPECT_TRUE(keys.insert(key.key).second) << key.caption;
    }
}

TEST(VantageKeys, MoveEyeAlongItsAxesAndReset) {
    const auto after = [](char32_t key) {
        Vantage vantage;
        client::vantage_key(key)->press(vantage, points);
        return went(vantage);
    };
    EXPECT_LT((after(U'l') - Vec3f(5e-3f, 0.0f, 0.0f)).norm(), 1e-6f);
    EXPECT_LT((after(U'j') - Vec3f(-5e-3f, 0.0f, 0.0f)).norm(), 1e-6f);
    EXPECT_LT((after(U'i') - Vec3f(0.0f, 5e-3f, 0.0f)).norm(), 1e-6f);
    EXPECT_LT((after(U'k') - Vec3f(0.0f, -5e-3f, 0.0f)).norm(), 1e-6f);
    EXPECT_LT((after(U'o') - Vec3f(0.0f, 0.0f, 5e-3f)).norm(), 1e-6f);
    EXPECT_LT((after(U'u') - Vec3f(0.0f, 0.0f, -5e-3f)).norm(), 1e-6f);
    Vantage moved{.eye = view::TraineeEye(Vec3f(0.1f, 0.1f, 0.1f))};
    client::vantage_key(U'c')->press(moved, points);
    EXPECT_LT(went(moved).norm(), 1e-6f);
    EXPECT_EQ(client::vantage_key(U'q'), nullptr);
}

TEST(Loupe, EnlargesTheEyesPictureOnly) {
    view::SceneView scene;
    synthetic::fill(scene, synthetic::make_scene());
    // Size of the glottis in the picture: the tangent that a metre fills.
    const auto scale = [&](const char* view, const Vantage& from) {
        return render::view_named(view)->camera(scene, from).projection(1.0f)(1, 1);
    };
    Vantage worn;
    client::vantage_key(client::loupe_key)->press(worn, points);
    EXPECT_NEAR(scale("eye", worn) / scale("eye", {}), render::Loupe::usual_magnification, 1e-3f);
    EXPECT_EQ(scale("overview", worn), scale("overview", {}));
    EXPECT_EQ(went(worn), went(Vantage())) << "the published eye stays";
    // The wheel changes the magnification instead of the distance, and the loupe remembers it.
    const float before = worn.loupe.magnification;
    client::drag(worn, *render::view_named("eye"), {.notches = 1.0f}, points);
    EXPECT_GT(worn.loupe.magnification, 1.1f * before);
    EXPECT_EQ(went(worn), went(Vantage()));
    const float chosen = worn.loupe.magnification;
    client::vantage_key(client::loupe_key)->press(worn, points);
    EXPECT_FALSE(worn.loupe.on());
    client::vantage_key(client::loupe_key)->press(worn, points);
    EXPECT_EQ(worn.loupe.magnification, chosen);
    client::drag(worn, *render::view_named("eye"), {.notches = 100.0f}, points);
    EXPECT_EQ(worn.loupe.magnification, render::Loupe::max_magnification);
    client::drag(worn, *render::view_named("eye"), {.notches = -100.0f}, points);
    EXPECT_TRUE(worn.loupe.on());
}

TEST(Mouse, MovesEyeOrOrbitDependingOnView) {
    const hands::Drag sideways{.x = 50.0f, .y = -20.0f, .notches = 1.0f};
    Vantage eye;
    client::drag(eye, *render::view_named("eye"), sideways, points);
    EXPECT_GT(went(eye).x(), 5e-3f);
    EXPECT_GT(went(eye).y(), 2e-3f) << "up in the picture is up";
    EXPECT_LT(went(eye).z(), -5e-3f) << "the wheel brings it nearer";
    EXPECT_EQ(eye.orbit.azimuth, Vantage().orbit.azimuth);
    Vantage onlooker;
    client::drag(onlooker, *render::view_named("overview"), sideways, points);
    EXPECT_EQ(went(onlooker), went(Vantage()));
    EXPECT_LT(onlooker.orbit.azimuth, Vantage().orbit.azimuth);
    EXPECT_LT(onlooker.orbit.distance, Vantage().orbit.distance);
}

TEST(Mouse, RightButtonTurnsGaze) {
    Vantage vantage;
    client::drag(vantage, *render::view_named("eye"), {.x = 100.0f, .right_button = true}, points);
    EXPECT_LT(went(vantage).norm(), 1e-6f);
    const RigidTransform straight = view::TraineeEye().pose(points), aside = vantage.eye.pose(points);
    EXPECT_GT((straight.inverse().rotation * (aside.rotation * -Vec3f::UnitZ())).x(), 0.05f);
}

TEST(Mouse, RotatesAndShiftsSectionPlane) {
    Vantage turned, shifted;
    client::drag(turned, *render::view_named("section"), {.x = 100.0f}, points);
    const render::CutPlane plane = turned.section.plane(points);
    EXPECT_NEAR(plane.normal.x(), std::cos(35.0f * degree), 1e-5f);
    client::drag(shifted, *render::view_named("section"), {.notches = 3.0f}, points);
    EXPECT_NEAR(shifted.section.plane(points).origin.x(), 3e-3f, 1e-6f);
    client::drag(shifted, *render::view_named("section"), {.y = 30.0f, .right_button = true}, points);
    EXPECT_NEAR(shifted.section.plane(points).origin.x(), 0.0f, 1e-6f);
    EXPECT_EQ(went(turned), went(Vantage()));
    client::vantage_key(U'x')->press(turned, points);
    EXPECT_EQ(turned.section, render::Section());
}

// With several pictures side by side, the one in which the button was pressed counts.
TEST(Mouse, DragStaysWithItsInitialView) {
    constexpr int width = 960, height = 540;
    view::SceneView scene;
    synthetic::fill(scene, synthetic::make_scene());
    for (const auto& [view, tile] : client::layout(client::selection_named("all")->plain, width, height)) {
        client::Controls controls(*client::selection_named("all"), nullptr);
        controls.drag({.from_x = static_cast<float>(tile.x + tile.width / 2),
                       .from_y = static_cast<float>(tile.y + tile.height / 2),
                       .x = 2000.0f},
                      scene, width, height);
        EXPECT_EQ(controls.vantage().orbit.azimuth != Vantage().orbit.azimuth,
                  view->mouse_target == render::MouseTarget::onlooker)
            << view->name;
        EXPECT_EQ(controls.vantage().eye.offset() != Vec3f::Zero(),
                  view->mouse_target == render::MouseTarget::eye)
            << view->name;
        EXPECT_EQ(controls.vantage().section != render::Section(),
                  view->mouse_target == render::MouseTarget::section)
            << view->name;
    }
}

}  // namespace
}  // namespace eti
