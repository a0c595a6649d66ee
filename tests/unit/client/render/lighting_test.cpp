// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/lighting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"

namespace eti {
namespace {

float smoothstep(float from, float to, float x) {
    const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

// Reference: the light's formula in light_shaders.hpp, at points within the ball.
TEST(Light, CullingIsConservativeAndEffective) {
    const RigidTransform blade{quaternion_from(Vec3f(0.3f, -0.2f, 0.5f)), Vec3f(0.01f, -0.02f, 0.03f)};
    const render::Light lamp = render::blade_lamp(blade, 0.07f);
    Random random(11);
    const auto within = [&](float reach) {
        return Vec3f(reach * (2.0f * random.uniform() - 1.0f), reach * (2.0f * random.uniform() - 1.0f),
                     reach * (2.0f * random.uniform() - 1.0f));
    };
    int out = 0, lit = 0;
    for (int ball = 0; ball < 4000; ++ball) {
        const Vec3f centre = lamp.position + within(0.3f);
        const float radius = 0.01f * random.uniform();
        const bool reached = lamp.reaches(centre, radius);
        out += reached ? 0 : 1;
        for (int i = 0; i < 8; ++i) {
            const Vec3f place = centre + within(0.57f * radius);
            const Vec3f way = place - lamp.position;
            const float strength =
                smoothstep(lamp.cos_outer, lamp.cos_inner, way.normalized().dot(lamp.direction)) *
                lamp.reach * lamp.reach / (lamp.reach * lamp.reach + way.squaredNorm());
            if (strength * lamp.colour.maxCoeff() > 0.002f) {
                ++lit;
                EXPECT_TRUE(reached) << way.transpose();
            }
        }
    }
    EXPECT_GT(lit, 1000);
    EXPECT_GT(out, 1000);
}

}  // namespace
}  // namespace eti
