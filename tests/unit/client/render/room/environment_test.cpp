// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/room/environment.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/math/random.hpp"

namespace eti::render {
namespace {

Vec3f direction_of(Random& random) {
    for (;;) {
        const Vec3f p(2.0f * random.uniform() - 1.0f, 2.0f * random.uniform() - 1.0f,
                      2.0f * random.uniform() - 1.0f);
        if (p.norm() > 0.1f && p.norm() < 1.0f) {
            return p.normalized();
        }
    }
}

// Closed forms of irradiance / pi: a uniform sky gives its radiance; a radiance max(a . d, 0) hardly fits,
// but a radiance a . d gives 2/3 of a . n, and (a . d)^2 gives 1/4 + (a . n)^2 / 4.
TEST(Irradiance, MatchesClosedForms) {
    const Vec3f a = Vec3f(1.0f, -2.0f, 0.5f).normalized();
    const Irradiance uniform = irradiance_of([](const Vec3f&) { return Vec3f(0.2f, 0.5f, 0.9f); });
    const Irradiance linear = irradiance_of([&](const Vec3f& d) { return Vec3f::Constant(a.dot(d)); });
    const Irradiance square =
        irradiance_of([&](const Vec3f& d) { return Vec3f::Constant(a.dot(d) * a.dot(d)); });
    Random random(5);
    for (int k = 0; k < 200; ++k) {
        const Vec3f n = direction_of(random);
        const float an = a.dot(n);
        // 6 x 32 x 32 directions: the midpoint rule's error falls with the square of their distance, 0.06.
        EXPECT_NEAR((evaluate(uniform, n) - Vec3f(0.2f, 0.5f, 0.9f)).norm(), 0.0f, 2e-3f);
        EXPECT_NEAR(evaluate(linear, n).x(), 2.0f / 3.0f * an, 2e-3f);
        EXPECT_NEAR(evaluate(square, n).x(), 0.25f + 0.25f * an * an, 2e-3f);
    }
}

// Half a sky: (1 + cos) / 2 of its radiance, which is not of the second order: Ramamoorthi & Hanrahan 2001
// bound the error by 9 % of the maximum.
TEST(Irradiance, ApproximatesHalfASky) {
    const Irradiance half =
        irradiance_of([](const Vec3f& d) { return Vec3f::Constant(d.y() < 0.0f ? 1.0f : 0.0f); });
    Random random(6);
    for (int k = 0; k < 200; ++k) {
        const Vec3f n = direction_of(random);
        EXPECT_NEAR(evaluate(half, n).x(), 0.5f - 0.5f * n.y(), 0.09f);
    }
}

// The two colours that stand for the room at a low quality.
TEST(Irradiance, OfTheRoomAgreesWithLowQuality) {
    const Vec3f from_above = evaluate(room_irradiance(), -Vec3f::UnitY());
    const Vec3f from_below = evaluate(room_irradiance(), Vec3f::UnitY());
    EXPECT_NEAR(from_above.mean(), 0.367f, 0.12f);
    EXPECT_NEAR(from_below.mean(), 0.097f, 0.06f);
}

TEST(Environment, ReflectionOfASmoothRoomIsTheRoom) {
    Random random(7);
    const Radiance smooth = [](const Vec3f& d) {
        return Vec3f(1.0f + 0.5f * d.x(), 1.0f, 1.0f - 0.5f * d.z());
    };
    for (int k = 0; k < 50; ++k) {
        const Vec3f d = direction_of(random);
        EXPECT_LT((prefiltered(smooth, d, 0.1f, 64) - smooth(d)).norm(), 0.01f);
        // A rough mirror sees a mean over a wide cone, in which the linear part is weaker.
        EXPECT_LT(std::abs(prefiltered(smooth, d, 1.0f, 256).x() - 1.0f), std::abs(0.5f * d.x()) + 0.02f);
    }
}

TEST(Environment, RadianceIsPositiveAndBounded) {
    Random random(8);
    for (int k = 0; k < 2000; ++k) {
        const Vec3f seen = room_radiance(direction_of(random));
        EXPECT_GT(seen.minCoeff(), 0.0f);
        EXPECT_LT(seen.maxCoeff(), 4.0f);
    }
}

}  // namespace
}  // namespace eti::render
