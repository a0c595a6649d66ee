// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <algorithm>

#include "scene_picture.hpp"

namespace eti {
namespace {

using render::Pass;
using render::Quality;
using render::Shading;
using render::View;
using test::named;
using RoomPicture = test::ScenePicture;

// Eye of frontal_view().
Vec3f screen_centre, screen_normal, screen_up;

// Only the room, in front of the monitor.
View frontal_view(const render::SceneRenderer& renderer) {
    const render::RoomMeshes& room = renderer.meshes().room();
    screen_centre = room.pose() * room.screen()->centre;
    screen_normal = -Vec3f(-0.80f, 0.22f, -0.56f).normalized();
    screen_up = -Vec3f::UnitY();
    View view = named("overview");
    view.passes = {Pass::room};
    view.cameras = [](const view::SceneView&, const render::Vantage&) {
        render::Camera camera;
        camera.eye = screen_centre + 0.25f * screen_normal;
        camera.target = screen_centre;
        camera.up = screen_up;
        return std::vector{camera};
    };
    return view;
}

int pixels_where(const render::Image& image, bool (*such)(const std::uint8_t*)) {
    int count = 0;
    for (std::size_t p = 0; p < image.rgba.size(); p += 4) {
        count += such(&image.rgba[p]) ? 1 : 0;
    }
    return count;
}

TEST_F(RoomPicture, MonitorShowsVitalSigns) {
    (void)picture(named("overview"), scene_, Shading::lit);
    const View view = frontal_view(renderer_);
    const auto green = [](const std::uint8_t* p) { return p[1] > 150 && p[0] < 120 && p[2] < 150; };
    const auto cyan = [](const std::uint8_t* p) { return p[2] > 150 && p[0] < 120 && p[1] > 120; };
    const auto shown = [&](float heart_rate, float saturation) {
        msg::LiveMetrics metrics = synthetic::metrics(source_, scene_.simulation_time_ns(), 50.0f);
        synthetic::set(metrics, &LiveMeasures::heart_rate_per_min, heart_rate);
        synthetic::set(metrics, &LiveMeasures::oxygen_saturation_percent, saturation);
        scene_.apply(metrics);
        scene_.update();
        return picture(view, scene_, Shading::lit);
    };
    const render::Image without = shown(std::nanf(""), std::nanf("")), with = shown(138.0f, 86.0f),
                        other = shown(138.0f, 81.0f);
    ASSERT_GT(pixels_where(without, green), 20) << "a flat line and two dashes";
    EXPECT_GT(pixels_where(with, green), 2 * pixels_where(without, green)) << "three digits, R waves";
    EXPECT_GT(pixels_where(with, cyan), 2 * pixels_where(without, cyan));
    // Of the digits 86 and 81 only the last differs: five segments.
    EXPECT_LT(pixels_where(other, cyan), pixels_where(with, cyan));
    EXPECT_EQ(pixels_where(other, green), pixels_where(with, green));
}

TEST_F(RoomPicture, IsAbsentFromMeasurements) {
    for (const View& view : render::views()) {
        const render::Image ids = picture(view, scene_, Shading::object_id);
        View bare = view;
        std::erase(bare.passes, Pass::room);
        std::erase(bare.passes, Pass::hands);
        EXPECT_EQ(ids.rgba, picture(bare, scene_, Shading::object_id).rgba) << view.name;
    }
}

TEST_F(RoomPicture, LensInMouthSeesNeitherRoomNorHands) {
    const Quality& high = render::qualities().back();
    render::SceneRenderer renderer(high);
    const auto drawn = [&](const View& view) {
        renderer.sync(scene_);
        renderer.draw(view, scene_, target_, {0, 0, test::width, test::height});
        return target_.read().rgba;
    };
    View bare = named("laryngoscope");
    std::erase(bare.passes, Pass::room);
    std::erase(bare.passes, Pass::hands);
    EXPECT_EQ(drawn(named("laryngoscope")), drawn(bare));
}

TEST_F(RoomPicture, HandsCanBeHidden) {
    renderer_.sync(scene_);
    const auto drawn = [&](bool hands) {
        renderer_.draw(named("overview"), scene_, target_, {0, 0, test::width, test::height},
                       {.hands = hands});
        return target_.read();
    };
    const render::Image with = drawn(true), without = drawn(false);
    // Nitrile gloves are the only violet objects.
    const auto violet = [](const std::uint8_t* p) { return p[2] > p[1] + 25 && p[1] <= p[0] + 25; };
    EXPECT_GT(pixels_where(with, violet), test::width * test::height / 100);
    EXPECT_LT(pixels_where(without, violet), pixels_where(with, violet) / 10);
}

TEST_F(RoomPicture, EveryQualityDrawsEveryView) {
    for (const Quality& quality : render::qualities()) {
        render::SceneRenderer renderer(quality);
        render::RenderTarget target(test::width, test::height, quality.samples);
        renderer.sync(scene_);
        for (const View& view : render::views()) {
            renderer.draw(view, scene_, target, {0, 0, test::width, test::height});
            const render::Image image = target.read();
            const int black =
                pixels_where(image, [](const std::uint8_t* p) { return p[0] + p[1] + p[2] == 0; });
            EXPECT_LT(black, view.lens ? test::width * test::height : 100)
                << view.name << ", " << quality.name;
        }
    }
}

}  // namespace
}  // namespace eti
