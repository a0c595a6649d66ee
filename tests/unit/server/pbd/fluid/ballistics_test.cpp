// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Flight and impact against the scheme's own exact solution, for particles, liquid and rods.
#include <gtest/gtest.h>

#include <tuple>

#include "server/pbd/contact/contact.hpp"
#include "server/pbd/fluid/fluid.hpp"
#include "tests/support/cluster_block.hpp"
#include "tests/support/rod_fixture.hpp"

namespace eti::pbd {
namespace {

constexpr double flight = 0.1;  // [s]
const Vec3f tilted_gravity(0.4f, -1.0f, -9.81f);
const Vec3f start(0.01f, 0.02f, 0.03f);
const Vec3f speed(0.5f, -0.3f, 1.1f);

/// Trajectory of semi-implicit Euler: a substep adds g dt to the velocity, moves by it, and keeps the share
/// `keep` of it. u_k = keep^(k-1) (v + g dt) + g dt (1 - keep^(k-1)) / (1 - keep) is the speed of substep k,
/// and the displacement dt times their sum.
Vec3d exact_way(double dt, int count, double keep) {
    const Vec3d g = tilted_gravity.cast<double>();
    const Vec3d v = speed.cast<double>();
    if (keep == 1.0) {
        return count * dt * v + 0.5 * count * (count + 1.0) * dt * dt * g;
    }
    const double sum = (1.0 - std::pow(keep, count)) / (1.0 - keep);
    return dt * (sum * (v + dt * g) + (count - sum) / (1.0 - keep) * dt * g);
}

/// Bound for rounding [m]: in each of n substeps position and prediction round by ulp / sqrt(12) of a
/// coordinate, and the velocity, their difference over dt, keeps the error: sqrt(2 n^3 / 3) of it in the end.
/// Three times that.
double flight_rounding(double largest_coordinate, int count) {
    const double ulp = std::exp2(std::floor(std::log2(largest_coordinate)) - 23.0);
    return 3.0 * ulp / std::sqrt(12.0) * std::sqrt(2.0 / 3.0 * std::pow(count, 3.0)) + ulp;
}

class Ballistics : public testing::TestWithParam<std::tuple<int, int>> {
  protected:
    [[nodiscard]] int rate() const { return std::get<0>(GetParam()) * std::get<1>(GetParam()); }
    [[nodiscard]] int count() const { return static_cast<int>(std::lround(flight * rate())); }
    [[nodiscard]] float dt() const { return 1.0f / static_cast<float>(rate()); }
};

TEST_P(Ballistics, ParticlesMatchDiscreteTrajectory) {
    for (const float damping : {0.0f, 12.0f}) {
        SoftBody body = test::loose_particles(1);
        body.settings.damping = damping;
        Particles& p = body.particles;
        p.position[0] = start;
        p.velocity[0] = speed;
        for (int n = 0; n < count(); ++n) {
            p.velocity[0] += dt() * tilted_gravity;
            test::substep(body, dt());
        }
        const double keep = std::exp(-double{damping} * double{dt()});
        const Vec3d way = exact_way(double{dt()}, count(), keep);
        EXPECT_LT((p.position[0].cast<double>() - start.cast<double>() - way).norm(),
                  flight_rounding(0.13, count()))
            << damping;
        EXPECT_GT(way.norm(), 0.02);
    }
}

TEST_P(Ballistics, DropletMatchesDiscreteTrajectory) {
    FluidSettings settings;
    settings.surface_tension = 0.0f;
    Fluid fluid(settings);
    ASSERT_TRUE(fluid.add(start, speed));
    for (int n = 0; n < count(); ++n) {
        fluid.step(dt(), tilted_gravity, {});
    }
    ASSERT_EQ(fluid.count(), 1u);
    const Vec3d way = exact_way(double{dt()}, count(), 1.0);
    EXPECT_LT((fluid.positions()[0].cast<double>() - start.cast<double>() - way).norm(),
              flight_rounding(0.13, count()));
}

TEST_P(Ballistics, LooseTubeMatchesDiscreteTrajectory) {
    // Computed in double; the output is float32 of 0.3 m: 3e-8 m in each of three coordinates, twice.
    for (const float damping : {0.0f, 1.0f}) {
        RodSettings settings;
        settings.held = false;
        settings.velocity_damping = damping;
        Rod rod(Tube{}, settings, {});
        rod.predict(dt(), Vec3f::Zero(), {});
        for (std::uint32_t s = 0; s < rod.size(); ++s) {
            const auto mass = static_cast<float>(1.0 / rod.segments()[s].inverse_mass);
            rod.load(s, static_cast<float>(rod.segments()[s].behind) / rod.length(s),
                     mass * (1.0f + damping * dt()) * speed / dt());
        }
        rod.solve();
        rod.finish();
        const Vec3f from = rod.tip();
        test::run(rod, flight, dt(), tilted_gravity, {});
        const Vec3d way = exact_way(double{dt()}, count(), 1.0 / (1.0 + double{damping} * double{dt()}));
        // The push is a float32 impulse: 1e-7 of the displacement.
        EXPECT_LT(((rod.tip() - from).cast<double>() - way).norm(), 3e-7) << damping;
    }
}

// Thrown onto a floor with friction. The reference is the scheme for one particle in double: where the floor
// stops it, the push is the prevented penetration, and the slip is reduced by the coefficient times that.
TEST_P(Ballistics, ImpactAndSlideMatchDiscreteScheme) {
    DistanceGrid floor;
    floor.origin = Vec3f(-0.5f, -0.5f, -0.5f);
    floor.spacing = 1.0f;
    floor.size = {2, 2, 2};
    floor.value = {-0.5f, -0.5f, -0.5f, -0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
    const float friction = 0.25f, radius = 1e-3f;
    SoftBody body = test::loose_particles(1);
    Particles& p = body.particles;
    p.position[0] = Vec3f(0.0f, 0.0f, 3e-3f);
    p.velocity[0] = Vec3f(0.4f, 0.0f, -0.5f);
    double x = 0.0, z = double{p.position[0].z()}, u = double{p.velocity[0].x()},
           w = double{p.velocity[0].z()};
    const double step = double{dt()};
    int touched = 0;
    for (int n = 0; n < 3 * count(); ++n) {
        p.velocity[0].z() -= 9.81f * dt();
        body.predict(dt(), 1.0f);
        body.project(dt());
        p.predicted[0] += push_out_of(floor, p.position[0], p.predicted[0], radius, friction);
        body.finish(dt());

        w -= 9.81 * step;
        const double push = std::max(double{radius} - (z + step * w), 0.0);
        touched += push > 0.0 ? 1 : 0;
        const double held = std::min(double{friction} * push, std::fabs(step * u));
        const double moved = step * u - std::copysign(held, u);
        const double sunk = step * w + push;
        x += moved;
        z += sunk;
        u = moved / step;
        w = sunk / step;
    }
    EXPECT_GT(touched, count());
    // Floor and slide lie within 0.1 m; friction removes 0.25 of a push that is as uncertain as z.
    EXPECT_LT(std::fabs(double{p.position[0].x()} - x), flight_rounding(0.06, 3 * count()));
    // The floor's grid is a metre wide: its distances have the precision of half a metre.
    EXPECT_LT(std::fabs(double{p.position[0].z()} - z), 3e-8);
    EXPECT_EQ(p.velocity[0].x(), 0.0f) << "0.3 s are enough to stop it";
    // In continuous time: the impact reduces the speed by friction times the stopped speed, and the rest
    // slides u^2 / 2 mu g.
    const double fall = std::sqrt(0.25 + 2.0 * 9.81 * 2e-3);
    const double after = 0.4 - double{friction} * fall;
    const double landing = 0.4 * (fall - 0.5) / 9.81;
    EXPECT_NEAR(x, landing + 0.5 * after * after / (double{friction} * 9.81), 0.4 * 2.0 * step);
}

INSTANTIATE_TEST_SUITE_P(StepsAndSubsteps, Ballistics,
                         testing::Combine(testing::Values(60, 180, 240), testing::Values(1, 4, 8)));

}  // namespace
}  // namespace eti::pbd
