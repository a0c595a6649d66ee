// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/circulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "client/render/gl/headless_context.hpp"
#include "client/render/material.hpp"
#include "client/render/shaders/shaders.hpp"
#include "scene_picture.hpp"
#include "shader_values.hpp"

namespace eti {
namespace {

using render::Circulation;

Vec3f linear_colour_of(Tissue tissue) {
    return render::tissue_colour(tissue).array().pow(2.2f);
}

// What light tissue reflects at this saturation, away from hands and feet.
Vec3f perfused(const Vec3f& albedo, double saturation_percent, double heart_rate_per_min = 140.0) {
    render::ShaderProgram program("perfused", {},
                                  std::string(render::shaders::blood) +
                                      "layout(location = 0) in vec3 at; out vec4 result; void main() { "
                                      "result = vec4(perfused(at, 0.0), 1.0); }",
                                  {"result"});
    Circulation blood;
    blood.update(0.0, saturation_percent, heart_rate_per_min);
    program.use();
    program.set("circulation", blood.colouring());
    return test::computed(program, {albedo}).front().head<3>();
}

float blueness(const Vec3f& colour) {
    return colour.z() / colour.x();
}

TEST(Perfusion, LipsAreBlueAt60Percent) {
    const render::HeadlessContext context;
    const Vec3f lips = linear_colour_of(Tissue::lip);
    EXPECT_GT(blueness(perfused(lips, 60.0)), 2.0f * blueness(perfused(lips, 95.0)));
    EXPECT_LT(perfused(lips, 60.0).x(), 0.7f * lips.x()) << "darker, too";
    EXPECT_GT(blueness(perfused(lips, 70.0)), 1.5f * blueness(lips)) << "clear at 70 %";
    EXPECT_LT(blueness(perfused(lips, 85.0)), 1.2f * blueness(lips)) << "begins below 85 %";
}

TEST(Perfusion, HealthyLipsKeepTheirColour) {
    const render::HeadlessContext context;
    const Vec3f lips = linear_colour_of(Tissue::lip);
    EXPECT_EQ(perfused(lips, 97.0), lips);
}

TEST(Perfusion, ClothStaysWhiteInHypoxia) {
    const render::HeadlessContext context;
    const Vec3f cloth = linear_colour_of(Tissue::cloth);
    EXPECT_EQ(perfused(cloth, 40.0, 50.0), cloth);
}

TEST(Perfusion, BradycardiaIsPale) {
    const render::HeadlessContext context;
    const Vec3f lips = linear_colour_of(Tissue::lip);
    const Vec3f pale = perfused(lips, 97.0, 60.0);
    EXPECT_GT(pale.y() / pale.x(), 1.3f * lips.y() / lips.x());
}

TEST(Circulation, HandsFollowLater) {
    Circulation blood;
    blood.update(0.0, 97.0, 140.0);
    blood.update(1.0, 60.0, 140.0);
    EXPECT_FLOAT_EQ(blood.colouring().x(), 1.0f);
    EXPECT_LT(blood.colouring().y(), 0.1f);
    double time_s = 1.0;
    while (blood.colouring().y() < 0.5f && time_s < 120.0) {
        blood.update(time_s += 0.1, 60.0, 140.0);
    }
    EXPECT_GT(time_s, 5.0);
    EXPECT_LT(time_s, 30.0);
    for (; time_s < 60.0; time_s += 0.1) {
        blood.update(time_s, 97.0, 140.0);
    }
    EXPECT_EQ(blood.colouring(), Vec3f(Vec3f::Zero())) << "recovers";
}

TEST(Circulation, IsHealthyWithoutVitalSigns) {
    Circulation blood;
    blood.update(0.0, 50.0, 50.0);
    EXPECT_GT(blood.colouring().minCoeff(), 0.0f);
    blood.update(1.0, std::nullopt, std::nullopt);
    EXPECT_EQ(blood.colouring(), Vec3f(Vec3f::Zero()));
}

using CyanosisPicture = test::ScenePicture;

TEST_F(CyanosisPicture, NewbornTurnsBlueOnlyInHypoxia) {
    const render::Image ids = picture(test::named("overview"), scene_, render::Shading::object_id);
    // Sum of each channel over the patient's pixels: the monitor shows the saturation, too.
    const auto drawn = [&](float saturation_percent) {
        msg::LiveMetrics metrics = synthetic::metrics(source_, 2'000'000, 40.0f);
        synthetic::set(metrics, &LiveMeasures::oxygen_saturation_percent, saturation_percent);
        scene_.apply(metrics);
        scene_.update();
        const render::Image image = picture(test::named("overview"), scene_, render::Shading::lit);
        Eigen::Vector3i sum = Eigen::Vector3i::Zero();
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                if (ids.pixel(x, y)[0] == render::object_colour(Tissue::soft)[0]) {
                    sum += Eigen::Vector3i(image.pixel(x, y)[0], image.pixel(x, y)[1], image.pixel(x, y)[2]);
                }
            }
        }
        return sum;
    };
    const Eigen::Vector3i unknown = drawn(LiveMeasures::missing), healthy = drawn(97.0f), blue = drawn(60.0f);
    EXPECT_EQ(unknown, healthy);
    EXPECT_LT(blue.x(), 0.95 * healthy.x());
    EXPECT_GT(blue.z(), 1.01 * healthy.z());
}

}  // namespace
}  // namespace eti
