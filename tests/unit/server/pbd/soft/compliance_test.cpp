// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Stiffness belongs to the material: deflections must not depend on substeps or passes, or only as far as
// stated here.
#include <gtest/gtest.h>

#include "server/pbd/soft/links.hpp"
#include "tests/support/cluster_block.hpp"
#include "tests/support/rod_fixture.hpp"

namespace eti::pbd {
namespace {

constexpr double standard_gravity = 9.81;

// A particle on a link hangs m g / k below its length. At rest the pass exactly cancels gravity's prediction:
// (s + g dt^2) w / (w + 1 / k dt^2) = g dt^2 gives s = m g / k for any substep.
TEST(Compliance, LinkIsIndependentOfSubstep) {
    const float mass = 1e-4f, stiffness = 20.0f, length = 1e-2f;
    const double expected = double{mass} * standard_gravity / double{stiffness};
    for (const int rate : {90, 180, 720, 1440, 5760}) {
        const float dt = 1.0f / static_cast<float>(rate);
        Vec3f top = Vec3f::Zero(), end(0, 0, -length), velocity = Vec3f::Zero();
        const float keep = std::exp(-40.0f * dt);
        for (int n = 0; n < rate; ++n) {
            const Vec3f before = end;
            end += dt * (velocity + dt * Vec3f(0, 0, static_cast<float>(-standard_gravity)));
            project_link(top, end, 0.0f, 1.0f / mass, length, stiffness, dt);
            velocity = keep * (end - before) / dt;
        }
        // Coordinates of 1e-2 m round by 5e-10 m when predicted and when corrected. The link corrects a share
        // w / (w + 1 / k dt^2) of that: where it is small, 1 / (k w dt^2) roundings accumulate, 170 at 1/5760
        // s.
        const double answered = 1.0 / (1.0 + double{mass} / (double{stiffness} * double{dt} * double{dt}));
        EXPECT_NEAR(static_cast<double>(-end.z() - length), expected, 1e-9 / answered + 1e-9) << rate;
        EXPECT_LT(1e-9 / answered + 1e-9, 4e-3 * expected);
    }
}

// One pass propagates a displacement from link to link: with rigid links between equal masses, each particle
// gets half of its neighbour's. Colouring into rounds without common particles would propagate it by two
// particles only, and links would share the load with fewer others.
TEST(Compliance, LinkPassPropagatesAlongChain) {
    constexpr std::size_t links = 32;
    constexpr float pulled = 1e-3f;
    Particles p;
    p.resize(links + 1);
    std::vector<std::array<std::uint32_t, 2>> ends;
    for (std::uint32_t i = 0; i <= links; ++i) {
        p.position[i] = p.predicted[i] = p.rest[i] = Vec3f(-2e-3f * static_cast<float>(i), 0, 0);
        p.inverse_mass[i] = i == 0 ? 0.0f : 1e4f;
        if (i < links) {
            ends.push_back({i, i + 1});
        }
    }
    Links chain;
    chain.configure(ends, std::vector<float>(links, 1e12f), p);
    p.predicted[0].x() += pulled;
    chain.project(p, 1.0f / 1440.0f);
    for (std::size_t i = 1; i < 8; ++i) {
        EXPECT_NEAR(p.predicted[i].x() - p.position[i].x(), std::ldexp(pulled, -static_cast<int>(i)), 1e-8f)
            << i;
    }
}

// The rod's joints and loads are solved together: more passes only correct nonlinearity, which at a
// deflection of a tenth is (1/10)^2 of the rest per Newton pass; over time, single passes achieve the same.
TEST(Compliance, RodIsIndependentOfPassCount) {
    std::vector<Vec3f> tip;
    for (const int passes : {1, 2, 4, 8}) {
        Rod rod(test::cantilever(), test::damped(32), {});
        test::run(rod, test::settled, 1.0f / 180.0f, Vec3f::Zero(), {}, Vec3f(0, 0.01f, 0), passes);
        tip.push_back(rod.tip());
    }
    ASSERT_GT(tip[0].y(), 0.01f);
    // e^-15 of the displacement (see rod_fixture.hpp) and float32 of 0.16 m.
    for (const Vec3f& other : tip) {
        EXPECT_LT((other - tip[0]).norm(), 1e-6f * tip[0].y() + 3e-8f);
    }
}

/// Sag of the free end of a block that hangs from its uppermost layer [m], at rest.
double sag(float dt) {
    SoftBody body = test::cluster_block(5, 8e3f, Vec3f::Zero(), 1);
    body.settings.damping = 40.0f;
    Particles& p = body.particles;
    for (int n = 0; n < static_cast<int>(1.5f / dt); ++n) {
        for (std::size_t i = 0; i < p.size(); ++i) {
            if (p.inverse_mass[i] > 0.0f) {
                p.velocity[i].z() -= static_cast<float>(standard_gravity) * dt;
            }
        }
        test::substep(body, dt);
    }
    double low = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        low = std::max(low, static_cast<double>(p.rest[i].z() - p.position[i].z()));
    }
    return low;
}

// A single pass propagates a load from cluster to cluster at g dt^2 for each, in addition to the springs' m g
// / k. The body is too soft by k dt^2 / m at the most, with k / m = 5 E V / (m r^2) of a membership (see
// ShapeMatching), and four times less for half the substep. At the shipped 1/1440 s and 2 mm that exceeds the
// stiffness itself, as the accuracy chart shows for loaded clusters.
TEST(Compliance, ClustersConvergeQuadraticallyInSubstep) {
    const float dt = 1.0f / 1440.0f;
    const double coarse = sag(dt), middle = sag(dt / 2.0f), fine = sag(dt / 4.0f);
    EXPECT_NEAR((coarse - middle) / (middle - fine), 4.0, 0.1);
    const double limit = fine - (middle - fine) / 3.0;
    const double h = double{test::cluster_spacing};
    const double stiffness_over_mass =
        5.0 * 8e3 * h * h * h / (double{test::cluster_particle_mass} * (5.0 / 3.0) * 2.0 * h * h);
    const double bound = stiffness_over_mass * double{dt} * double{dt};
    EXPECT_LT((coarse - limit) / limit, bound);
    EXPECT_GT((coarse - limit) / limit, 0.3 * bound);
}

// A moved weight on a link stretches it by m a / k, as gravity does above.
TEST(Compliance, BodyAccelerationActsLikeWeight) {
    SoftBody body;
    body.particles.resize(2);
    body.particles.rest = {Vec3f::Zero(), Vec3f(0, 0, -1e-2f)};
    body.particles.position = body.particles.predicted = body.particles.rest;
    const float mass = 1e-4f, stiffness = 20.0f;
    body.particles.inverse_mass = {0.0f, 1.0f / mass};
    body.links.configure({{0, 1}}, {stiffness}, body.particles);
    ShapeMatching::Description none;
    none.first = {0};
    none.fitting_mass = none.particle_volume = {mass, mass};
    body.shapes.configure(none, body.particles);
    body.settings.damping = 40.0f;
    body.settings.acceleration = Vec3f(0, 0, -3.0f);
    for (const float softer : {1.0f, 2.0f}) {
        body.links.set_stiffness(std::vector{stiffness / softer});
        for (int n = 0; n < 1440; ++n) {
            test::substep(body, 1.0f / 1440.0f);
        }
        const double expected = 1e-4 * 3.0 / 20.0 * static_cast<double>(softer);
        EXPECT_NEAR(static_cast<double>(-body.particles.position[1].z() - 1e-2f), expected, 2e-3 * expected);
    }
    EXPECT_EQ(body.particles.position[0], Vec3f(Vec3f::Zero()));
}

}  // namespace
}  // namespace eti::pbd
