// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/breathing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "client/render/gl/headless_context.hpp"
#include "client/render/shaders/shaders.hpp"
#include "shader_values.hpp"

namespace eti {
namespace {

using render::Breathing;

TEST(Breathing, VentilatesAtPublishedRate) {
    Breathing lungs;
    lungs.update(0.0, true);
    int breaths = 0;
    float before = 0.0f, highest = 0.0f, lowest = 1.0f;
    for (double time_s = 0.01; time_s < 60.0; time_s += 0.01) {
        lungs.update(time_s, true);
        const float now = lungs.inflation();
        breaths += before < 0.5f && now >= 0.5f ? 1 : 0;
        highest = std::max(highest, now);
        lowest = time_s > 2.0 ? std::min(lowest, now) : lowest;
        before = now;
    }
    EXPECT_GE(breaths, 40);
    EXPECT_LE(breaths, 60);
    EXPECT_GT(highest, 0.9f);
    EXPECT_LT(lowest, 0.05f) << "breathes out";
}

TEST(Breathing, LungsEmptyInApnoea) {
    Breathing lungs;
    for (double time_s = 0.0; time_s < 1.5; time_s += 0.01) {
        lungs.update(time_s, true);
    }
    for (double time_s = 1.5; time_s < 3.0; time_s += 0.01) {
        lungs.update(time_s, false);
    }
    EXPECT_LT(lungs.inflation(), 1e-4f);
}

TEST(Breathing, SurvivesGapsAndRestarts) {
    Breathing lungs;
    lungs.update(0.0, true);
    lungs.update(1e6, true);
    EXPECT_GE(lungs.inflation(), 0.0f);
    EXPECT_LE(lungs.inflation(), 1.0f);
    lungs.update(1.0, true);
    EXPECT_EQ(lungs.inflation(), 0.0f) << "a session that started again";
}

// Of places in model coordinates [mm], in a newborn of `size` relative to 3.5 kg.
std::vector<float> rises(const std::vector<Vec3f>& model, float size) {
    render::ShaderProgram program("chest", {},
                                  std::string(render::shaders::chest_rise) +
                                      "layout(location = 0) in vec3 at; out vec4 result; void main() { "
                                      "result = vec4(chest_rise(at)); }",
                                  {"result"});
    program.use();
    program.set("breath", Eigen::Vector2f(1.0f, size));
    std::vector<Vec3f> points;
    for (const Vec3f& p : model) {
        const Vec3f off = 1e-3f * size * (p - Vec3f(0.0f, 45.5f, -6.9f));
        points.emplace_back(off.x(), -off.y(), off.z());
    }
    std::vector<float> found;
    for (const Eigen::Vector4f& value : test::computed(program, points)) {
        found.push_back(value.x());
    }
    return found;
}

// Volume-targeted ventilation gives 4 to 6 mL/kg.
TEST(ChestRise, DisplacesTidalVolume) {
    const render::HeadlessContext context;
    constexpr float step = 2.0f;
    std::vector<Vec3f> front;
    for (float x = -100.0f; x <= 100.0f; x += step) {
        for (float z = -250.0f; z <= -40.0f; z += step) {
            front.emplace_back(x, 55.0f, z);
        }
    }
    for (const float size : {1.0f, 0.68f}) {
        double volume = 0.0;  // [m3]
        for (const float rise : rises(front, size)) {
            volume += rise * std::pow(1e-3 * step * size, 2);
        }
        const double weight = 3.5 * std::pow(size, 3);
        EXPECT_GT(1e6 * volume / weight, 4.0) << size;
        EXPECT_LT(1e6 * volume / weight, 6.0) << size;
    }
}

TEST(ChestRise, HeadNeckAndLimbsStay) {
    const render::HeadlessContext context;
    // Chin, throat, shoulder, hand, knee, back.
    const std::vector<Vec3f> places = {{0, 40, -20},  {0, 20, -55},    {45, 0, -70},
                                       {185, 5, -70}, {115, 65, -232}, {0, -45, -140}};
    for (const float rise : rises(places, 1.0f)) {
        EXPECT_EQ(rise, 0.0f);
    }
    EXPECT_GT(rises({{0, 70, -160}}, 1.0f).front(), 1e-3f) << "the abdomen rises";
}

}  // namespace
}  // namespace eti
