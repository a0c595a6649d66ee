// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "scene_picture.hpp"

namespace eti {
namespace {

using render::Pass;
using render::Shading;
using render::View;
using test::named;
using ToolsPicture = test::ScenePicture;

// Only the tools, from `eye` [m] towards `target`.
View tools_view(const Vec3f& eye, const Vec3f& target) {
    static Vec3f from, onto;
    from = eye;
    onto = target;
    View view = named("section");
    view.passes = {Pass::tools};
    view.cut = false;
    view.cameras = [](const view::SceneView&, const render::Vantage&) {
        render::Camera camera;
        camera.eye = from;
        camera.target = onto;
        camera.up = Vec3f::UnitY();
        camera.vertical_fov = 0.25f;
        camera.near_plane = 1e-3f;
        return std::vector{camera};
    };
    return view;
}

int luminance_of(const std::uint8_t* p) {
    return (2 * p[0] + 7 * p[1] + p[2]) / 10;
}

// Murphy's eye lies on the right and not on the left: through it the background is seen, where flat colours
// show the whole wall.
TEST_F(ToolsPicture, MurphyEyeOpensTheRightWallOnly) {
    const auto nodes = scene_.tube_nodes();
    const Vec3f tip = nodes.back(), along = (nodes[nodes.size() - 2] - tip).normalized();
    const Tube& tube = scene_.tube()->tube();
    const Vec3f eye_of_tube = tip + 1.5f * tube.outer_diameter * along;
    const Vec3f left = scene_.tube()->connector_pose().rotation * -Vec3f::UnitY();
    const auto darkest = [&](const Vec3f& side) {
        const View view = tools_view(eye_of_tube + 0.04f * side, eye_of_tube);
        const render::Image image = picture(view, scene_, Shading::lit);
        int least = 255;
        for (int y = test::height / 2 - 6; y <= test::height / 2 + 6; ++y) {
            for (int x = test::width / 2 - 6; x <= test::width / 2 + 6; ++x) {
                least = std::min(least, luminance_of(image.pixel(x, y)));
            }
        }
        return least;
    };
    EXPECT_LT(darkest(-left) + 15, darkest(left));
}

// The connector continues the tube beyond its end; it is drawn, but does not count for visibility.
TEST_F(ToolsPicture, ConnectorEndsTheTube) {
    const RigidTransform& pose = scene_.tube()->connector_pose();
    EXPECT_LT((pose.translation - scene_.tube_nodes().front()).norm(), 1e-6f);
    const Vec3f cone = pose * Vec3f(0.0f, 0.0f, -18e-3f);
    const View view = tools_view(cone + 0.15f * (pose.rotation * Vec3f::UnitX()), cone);
    const render::Image lit = picture(view, scene_, Shading::lit);
    const render::Image ids = picture(view, scene_, Shading::object_id);
    const std::uint8_t* background = lit.pixel(2, 2);
    const std::uint8_t* drawn = lit.pixel(test::width / 2, test::height / 2);
    const std::uint8_t* measured = ids.pixel(test::width / 2, test::height / 2);
    EXPECT_GT(std::abs(luminance_of(drawn) - luminance_of(background)), 10);
    EXPECT_EQ((test::Colour{measured[0], measured[1], measured[2]}), (test::Colour{0, 0, 0}));
}

// Details of the laryngoscope are drawn, but do not count for visibility.
TEST_F(ToolsPicture, DetailsDoNotChangeMeasurements) {
    const RigidTransform& blade = *scene_.laryngoscope_pose();
    const float top = scene_.keys()->laryngoscope().capsules[0].b.y() + 9e-3f;
    const Vec3f cap = blade * Vec3f(0.0f, top + 1.2e-3f, 0.0f);  // within the dome, above the plain handle
    const View view = tools_view(cap + 0.2f * (blade.rotation * Vec3f::UnitX()), cap);
    const render::Image lit = picture(view, scene_, Shading::lit);
    const render::Image ids = picture(view, scene_, Shading::object_id);
    const std::uint8_t* drawn = lit.pixel(test::width / 2, test::height / 2);
    const std::uint8_t* measured = ids.pixel(test::width / 2, test::height / 2);
    EXPECT_GT(luminance_of(drawn), 60);
    EXPECT_EQ((test::Colour{measured[0], measured[1], measured[2]}), (test::Colour{0, 0, 0}));
}

}  // namespace
}  // namespace eti
