// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/shader_program.hpp"
#include "client/render/gl/shadow_map.hpp"
#include "client/render/shaders/shaders.hpp"
#include "shader_values.hpp"

namespace eti {
namespace {

constexpr double pi = std::numbers::pi;

// Reference: on a paraboloid, a ray at an angle from the axis lies at the tangent of half that angle.
TEST(LampMap, IsParaboloidProjection) {
    const render::HeadlessContext context;
    render::ShaderProgram program(
        "lamp map", {"FROM_LAMP"},
        std::string(render::shaders::lamp_map) +
            "layout(location = 0) in vec3 at; out vec4 result; void main() { result = in_lamp_map(at); }",
        {"result"});
    render::Light lamp;
    lamp.position = Vec3f(0.02f, -0.01f, 0.03f);
    lamp.direction = Vec3f(0.2f, -0.5f, 0.6f).normalized();
    const float nearest = 1e-3f, farthest = 0.1f;
    program.use();
    program.set("to_lamp", render::world_to_lamp(lamp));
    program.set("lamp_depths", Eigen::Vector2f(nearest, farthest));
    const Vec3f aside = lamp.direction.unitOrthogonal();
    std::vector<Vec3f> points;
    std::vector<double> angles, distances;
    for (int ring = 0; ring <= 10; ++ring) {
        for (int side = 0; side < 8; ++side) {
            angles.push_back(0.5 * pi * ring / 10);
            distances.push_back(2e-3 + 9e-3 * ((3 * side + ring) % 8));
            const Eigen::AngleAxisf turn(static_cast<float>(2 * pi * side / 8), lamp.direction);
            const auto angle = static_cast<float>(angles.back());
            const Vec3f way = std::cos(angle) * lamp.direction + std::sin(angle) * (turn * aside);
            points.push_back(lamp.position + static_cast<float>(distances.back()) * way);
        }
    }
    const std::vector<Eigen::Vector4f> places = test::computed(program, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        // Single precision of positions 0.05 m away, over distances of 2 mm and more.
        EXPECT_NEAR(places[i].head<2>().norm(), std::tan(0.5 * angles[i]), 1e-5) << i;
        EXPECT_NEAR(places[i].z(), (distances[i] - nearest) / (farthest - nearest), 1e-5) << i;
        EXPECT_NEAR(places[i].w(), distances[i] * std::cos(angles[i]), 1e-7) << i;
    }
    // On opposite sides, not all at one point.
    EXPECT_LT(places[41].head<2>().dot(places[45].head<2>()), -0.05f);
}

// Reference: the integral of the cosines at both ends over the disc of the mouth, divided by pi and by the
// squared distance.
TEST(MouthOpeningLight, MatchesViewFactorOfDisc) {
    const render::HeadlessContext context;
    render::ShaderProgram program("mouth", {},
                                  "uniform float occlusion;" + std::string(render::shaders::through_mouth) +
                                      "layout(location = 0) in vec3 at; out vec4 result;"
                                      "void main() { result = vec4(open_at(at)); }",
                                  {"result"});
    const double radius = 8e-3;
    program.use();
    program.set("mouth", Eigen::Vector4f(0.01f, 0.02f, 0.03f, static_cast<float>(radius)));
    program.set("inward", Vec3f(0.0f, 0.6f, -0.8f));
    program.set("occlusion", 1.0f);
    const std::vector<double> depths = {-0.01, 0.0, 2e-3, 8e-3, 0.02, 0.05};
    std::vector<Vec3f> points;
    for (const double depth : depths) {
        points.push_back(Vec3f(0.01f, 0.02f, 0.03f) + static_cast<float>(depth) * Vec3f(0.0f, 0.6f, -0.8f));
    }
    const std::vector<Eigen::Vector4f> open = test::computed(program, points);
    for (std::size_t i = 0; i < depths.size(); ++i) {
        double share = depths[i] <= 0.0 ? 1.0 : 0.0;
        constexpr int rings = 4000;
        for (int ring = 0; depths[i] > 0.0 && ring < rings; ++ring) {
            const double r = radius * (ring + 0.5) / rings, squared = r * r + depths[i] * depths[i];
            share += depths[i] * depths[i] / (squared * squared) * 2.0 * r * radius / rings;
        }
        EXPECT_NEAR(open[i].x(), share, 1e-4) << depths[i];
    }
    program.set("occlusion", 0.0f);  // cut open
    EXPECT_EQ(test::computed(program, points).back().x(), 1.0f);
}

}  // namespace
}  // namespace eti
