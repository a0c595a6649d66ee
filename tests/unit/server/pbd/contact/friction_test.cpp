// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The law of CoulombFriction at the blade's capsule and at a distance grid, in many directions.
#include <gtest/gtest.h>

#include <numbers>
#include <tuple>

#include "common/math/random.hpp"
#include "server/pbd/contact/contact.hpp"
#include "tests/support/cluster_block.hpp"

namespace eti::pbd {
namespace {

constexpr float friction_gravity = 9.81f;
constexpr float friction = 0.3f;
constexpr double time_watched = 0.1;  // [s]

/// A plane of any orientation through the origin, as a solid.
struct Incline {
    Vec3f normal, downhill;
    DistanceGrid grid;
    MovingCapsule capsule;

    Incline(float angle, float azimuth, const Quatf& turn) {
        // Gravity stays -z in the unrotated frame; the plane is tilted, and both are rotated at random.
        const Vec3f aside(std::cos(azimuth), std::sin(azimuth), 0.0f);
        normal = turn * Vec3f(std::sin(angle) * aside + std::cos(angle) * Vec3f::UnitZ());
        downhill = turn * Vec3f(std::cos(angle) * aside - std::sin(angle) * Vec3f::UnitZ());
        grid.origin = Vec3f::Constant(-0.1f);
        grid.spacing = 0.2f;
        grid.size = {2, 2, 2};
        for (int k = 0; k < 8; ++k) {
            grid.value.push_back(normal.dot(grid.node(k & 1, k >> 1 & 1, k >> 2)));
        }
        // A cylinder's generator is straight: along it, a slope is a plane's.
        capsule.radius = 0.05f;
        capsule.a = capsule.a_before = -0.5f * downhill - capsule.radius * normal;
        capsule.b = capsule.b_before = 0.5f * downhill - capsule.radius * normal;
    }
};

/// Downhill displacement [m] of a particle placed at rest on an incline, and its deviation from that line.
std::pair<double, double> slide(const Incline& on, const Vec3f& weight, float dt, bool capsule,
                                const Friction& coefficients) {
    SoftBody body = test::loose_particles(1);
    Particles& p = body.particles;
    for (int n = 0; n < static_cast<int>(std::lround(time_watched / double{dt})); ++n) {
        p.velocity[0] += dt * weight;
        body.predict(dt, 1.0f);
        p.predicted[0] += capsule ? push_out_of(on.capsule, p.position[0], p.predicted[0], 0.0f, coefficients)
                                  : push_out_of(on.grid, p.position[0], p.predicted[0], 0.0f, coefficients);
        body.finish(dt);
    }
    const Vec3f x = p.position[0];
    return {double{x.dot(on.downhill)}, double{(x - x.dot(on.downhill) * on.downhill).norm()}};
}

class CoulombFriction : public testing::TestWithParam<std::tuple<bool, int, Friction>> {};

// A plane tilted by less than atan of the static coefficient holds; beyond, the particle slides by g (sin -
// mu cos) dt^2 n (n + 1) / 2 in this scheme, with the kinetic coefficient.
TEST_P(CoulombFriction, SticksBelowThresholdAndSlidesAbove) {
    const auto [capsule, rate, coefficients] = GetParam();
    const float dt = 1.0f / static_cast<float>(rate);
    const auto count = static_cast<double>(std::lround(time_watched * rate));
    Random random(1);
    for (int trial = 0; trial < 40; ++trial) {
        const float azimuth = 2.0f * std::numbers::pi_v<float> * random.uniform();
        const Quatf turn =
            Quatf(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
        for (const float tangent : {0.5f, 0.95f, 1.05f, 2.0f}) {
            const float angle = std::atan(tangent * coefficients.static_coefficient);
            const Incline on(angle, azimuth, turn);
            const Vec3f weight = turn * Vec3f(0, 0, -friction_gravity);
            const auto [way, aside] = slide(on, weight, dt, capsule, coefficients);
            // Contact is a float32 distance to an axis 50 mm away: 4e-9 m. A push is g dt^2 = 5e-6 m at the
            // least, so the force is uncertain by a thousandth.
            if (tangent < 1.0f) {
                EXPECT_LT(std::fabs(way), 1e-7) << tangent;
            } else {
                const double pull = double{friction_gravity} *
                                    (std::sin(double{angle}) -
                                     double{coefficients.kinetic_coefficient} * std::cos(double{angle}));
                const double expected = pull * count * (count + 1.0) / 2.0 * double{dt} * double{dt};
                EXPECT_NEAR(way, expected,
                            1e-3 * double{friction_gravity} * 0.5 * time_watched * time_watched)
                    << tangent;
                EXPECT_GT(way, 0.5 * expected);
            }
            EXPECT_LT(aside, 1e-6) << tangent;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CapsuleAndGrid, CoulombFriction,
                         testing::Combine(testing::Bool(), testing::Values(180, 720, 1440),
                                          testing::Values(Friction(friction), Friction(0.4f, 0.2f))));

// Around the capsule, any slip: the part beyond the coefficient times the push remains, in the slip's
// direction.
TEST(CapsuleFriction, ReducesSlipByCoulombBound) {
    Random random(2);
    MovingCapsule capsule;
    capsule.a = capsule.a_before = Vec3f(-0.02f, 0.01f, 0.0f);
    capsule.b = capsule.b_before = Vec3f(0.03f, 0.02f, 0.05f);
    capsule.radius = 5e-3f;
    const Vec3f axis = (capsule.b - capsule.a).normalized();
    int stuck = 0;
    constexpr int trials = 500;
    for (int trial = 0; trial < trials; ++trial) {
        const Vec3f out = Quatf(Eigen::AngleAxisf(6.2832f * random.uniform(), axis)) * axis.unitOrthogonal();
        const Vec3f foot = capsule.a + (0.2f + 0.6f * random.uniform()) * (capsule.b - capsule.a);
        const float depth = 1e-4f;
        // Slip along the axis and around it, up to twice what friction holds; the predicted point is `depth`
        // deep.
        const float size = 2.0f * friction * depth * random.uniform();
        const float direction = 6.2832f * random.uniform();
        const Vec3f slip = size * (std::cos(direction) * axis + std::sin(direction) * axis.cross(out));
        const Vec3f predicted = foot + (capsule.radius - depth) * out;
        const Vec3f before = foot + capsule.radius * out - slip;
        const Vec3f after = predicted + push_out_of(capsule, before, predicted, 0.0f, friction);
        const float left = std::max(size - friction * depth, 0.0f);
        stuck += left == 0.0f ? 1 : 0;
        const Vec3f moved = after - before;
        // Coordinates of 5e-2 m round by 4e-9 m in a handful of operations.
        EXPECT_LT((moved - left * slip.normalized()).norm(), 3e-8f) << trial;
    }
    EXPECT_NEAR(stuck, trials / 2, 60);
}

}  // namespace
}  // namespace eti::pbd
