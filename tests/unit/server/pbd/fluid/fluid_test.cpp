// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/fluid/fluid.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/support/allocations.hpp"
#include "tests/support/threads.hpp"
#include "tests/unit/server/pbd/fluid/fluid_fixture.hpp"

namespace eti::pbd {
namespace {

using namespace fluid_fixture;

constexpr float pi_float = std::numbers::pi_v<float>;

/// A column with sleeping disabled, and one with it enabled.
class FluidColumn : public ::testing::TestWithParam<bool> {};

TEST_P(FluidColumn, AtRestHasHydrostaticPressureAndRestDensity) {
    constexpr int wide = 10, high = 16;
    FluidSettings settings = plain();
    settings.rest_time = GetParam() ? settings.rest_time : 0.0f;
    Fluid fluid(settings);
    fill(fluid, wide, wide, high);
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(wide, wide, 2 * high));
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    double height = 0.0;
    double lowest = 1.0, highest = 0.0;
    std::array<double, high> pressure{}, compression{};
    std::array<int, high> samples{};
    for (int n = 0; n < 2160; ++n) {
        fluid.step(dt, Vec3f(0, 0, -g), surroundings);
        if (n < 1440) {
            continue;
        }
        height = 2.0 * static_cast<double>(centre(fluid).z());
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
        for (std::size_t i = 0; i < fluid.count(); ++i) {
            const Vec3f x = fluid.positions()[i] / spacing;
            const auto layer = static_cast<std::size_t>(x.z());
            // Clear of the side walls by a kernel radius.
            if (layer < high && x.x() > 2 && x.x() < wide - 2 && x.y() > 2 && x.y() < wide - 2) {
                pressure[layer] += static_cast<double>(fluid.pressure(i));
                compression[layer] += static_cast<double>(fluid.compressions()[i]);
                ++samples[layer];
            }
        }
    }
    EXPECT_EQ(fluid.sleeping_count() > fluid.count() / 2, GetParam());
    // Nothing is lost, and the surface is steady: packing may differ by 3 % from the one that the kernel sums
    // are calibrated for (a lattice does), and over half a second it does not move.
    EXPECT_EQ(fluid.count(), static_cast<std::size_t>(wide * wide * high));
    EXPECT_NEAR(height, high * spacing, 0.03 * high * spacing);
    EXPECT_LT(highest - lowest, 0.005 * high * spacing);
    EXPECT_LT(agitation(fluid), 0.015);  // [m/s]; a fall from half the spacing gives ten times 0.01
    for (std::size_t layer = 1; layer + 3 < high; ++layer) {
        ASSERT_GT(samples[layer], 0);
        const double depth = height - (static_cast<double>(layer) + 0.5) * static_cast<double>(spacing);
        const double expected = 1000.0 * static_cast<double>(g) * depth;
        // The least-squares slope below is the sharper test. A layer's share of the kernel's slope on some 30
        // neighbours is accurate to 15 %, and the surface's position to half a particle.
        EXPECT_NEAR(pressure[layer] / samples[layer], expected, 0.15 * expected + 0.5 * 9.81) << layer;
        // Compressed by p / (rho c^2) = 0.16 % at most, and by what five iterations leave: 1 %.
        EXPECT_LT(compression[layer] / samples[layer], 0.015) << layer;
        EXPECT_GT(compression[layer] / samples[layer], -0.01) << layer;
    }
    // Least squares over the same layers. Errors uniform within 15 % of the mean pressure, 75 Pa, have a
    // deviation of 6.5 Pa; over 12 layers (inertia 143) that is 0.54 Pa a layer, 6 % of 9.81.
    constexpr int first = 1, last = high - 4;
    constexpr double middle = 0.5 * (first + last);
    double moment = 0.0, inertia = 0.0;
    for (int layer = first; layer <= last; ++layer) {
        const auto l = static_cast<std::size_t>(layer);
        moment += (layer - middle) * pressure[l] / samples[l];
        inertia += (layer - middle) * (layer - middle);
    }
    EXPECT_NEAR(-moment / (inertia * static_cast<double>(spacing)), 9810.0, 0.06 * 9810.0);
}

INSTANTIATE_TEST_SUITE_P(Sleep, FluidColumn, ::testing::Bool());

TEST(Fluid, VolumeIsConservedInRotatedVessel) {
    constexpr int wide = 8;
    Fluid fluid(plain());
    fill(fluid, wide, wide, wide);
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(wide, wide, 2 * wide));
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    const auto settled_height = [&] {
        for (int n = 0; n < 1440; ++n) {
            fluid.step(dt, Vec3f(0, 0, -g), surroundings);
        }
        return 2.0f * centre(fluid).z();
    };
    const float before = settled_height();
    for (int n = 0; n < 2880; ++n) {
        const float angle = 2.0f * pi_float * static_cast<float>(n) / 1440.0f;
        fluid.step(dt, g * Vec3f(std::sin(angle), 0, -std::cos(angle)), surroundings);
    }
    const float after = settled_height();
    EXPECT_EQ(fluid.count(), static_cast<std::size_t>(wide * wide * wide));
    // Packings differ: 2 %, the difference between a lattice's kernel sums and a liquid's being 3 %.
    EXPECT_NEAR(after, before, 0.02f * before);
    EXPECT_EQ(fluid.dropped_neighbours(), 0u);
}

TEST(Fluid, FreeBlobKeepsItsMomentum) {
    FluidSettings settings;
    settings.viscosity = 1e-5f;
    Fluid fluid(settings);
    fill_ball(fluid, 5e-3f);
    const Vec3f drift(0.03f, -0.02f, 0.01f), spin(0, 0, 5.0f);
    Fluid moving(settings);
    for (const Vec3f& x : by_id(fluid)) {
        moving.add(x, drift + spin.cross(x));
    }
    const Vec3d before = mean_velocity(moving);
    const auto turning = [&] {
        const Vec3f middle = centre(moving);
        double sum = 0.0;
        for (std::size_t i = 0; i < moving.count(); ++i) {
            const Vec3f arm = moving.positions()[i] - middle;
            sum += static_cast<double>(arm.cross(moving.velocities()[i] - drift).z());
        }
        return sum / static_cast<double>(moving.count());
    };
    const double turning_before = turning();
    for (int n = 0; n < 720; ++n) {
        moving.step(dt, Vec3f::Zero(), {});
    }
    // Pair terms cancel except for rounding: a displacement is rounded to 1e-7 of 1e-4 m, which over dt is
    // 1.4e-8 m/s; 720 random ones of 515 particles would be 2e-8 m/s in the mean. A bias could be 1e-5.
    EXPECT_LT((mean_velocity(moving) - before).norm(), 1e-5);
    // Forces are central, so the equations conserve angular momentum; steps of 0.7 ms at 5 rad/s cost 0.2 % a
    // radian.
    EXPECT_NEAR(turning(), turning_before, 0.02 * turning_before);
}

TEST(Fluid, DropOscillationMatchesSurfaceTension) {
    // Lamb's (1932, art. 275) ellipsoidal mode: omega^2 = 8 tension / (rho R^3). A drop released in a
    // stretched state is first round after a quarter of the period. 20 %: the integral of Kirkwood & Buff
    // takes the liquid as uniform beyond a particle, and the drop is six particles in radius (its surface is
    // known to half a particle: 12 % of the period).
    for (const float tension : {0.02f, 0.055f}) {
        FluidSettings settings = plain();
        settings.surface_tension = tension;
        Fluid round(settings);
        fill_ball(round, 6e-3f);
        for (int n = 0; n < 300; ++n) {
            round.step(dt, Vec3f::Zero(), {});
        }
        Fluid drop(settings);
        const float stretch = 1.25f;
        for (const Vec3f& x : by_id(round)) {
            drop.add(Vec3f(x.x() * stretch, x.y() / std::sqrt(stretch), x.z() / std::sqrt(stretch)));
        }
        const float cubed = 0.75f / pi_float * static_cast<float>(drop.count()) * drop.particle_volume();
        const float quarter = 0.5f * pi_float / std::sqrt(8.0f * tension / (1000.0f * cubed));
        const auto stretched = [&] {
            double along = 0.0, across = 0.0;
            for (const Vec3f& x : drop.positions()) {
                along += static_cast<double>(x.x() * x.x());
                across += 0.5 * static_cast<double>(x.y() * x.y() + x.z() * x.z());
            }
            return along > across;
        };
        int steps = 0;
        for (; stretched() && steps < 2000; ++steps) {
            drop.step(dt, Vec3f::Zero(), {});
        }
        EXPECT_NEAR(static_cast<float>(steps) * dt, quarter, 0.2f * quarter) << tension;
    }
}

TEST(Fluid, ShearWaveDecayMatchesViscosity) {
    // v_x = u sin(k z) decays at nu k^2. Compared with the same liquid without viscosity, from a settled
    // (disordered) start: 20 % for a second derivative from some 30 neighbours, a kernel of a third of
    // the wave's length and sums that are not calibrated.
    FluidSettings settings = plain();
    Fluid settled(settings);
    fill(settled, 12, 12, 18);
    const DistanceGrid solid = vessel(Vec3f::Zero(), spacing * at(12, 12, 40));
    FluidSurroundings surroundings;
    surroundings.solid = &solid;
    for (int n = 0; n < 700; ++n) {
        settled.step(dt, Vec3f(0, 0, -g), surroundings);
    }
    const float k = 2.0f * pi_float / 12e-3f, u = 0.1f;
    const auto amplitude = [&](float viscosity) {
        settings.viscosity = viscosity;
        Fluid fluid(settings);
        for (const Vec3f& x : settled.positions()) {
            fluid.add(x, Vec3f(u * std::sin(k * x.z()), 0, 0));
        }
        fluid.step(dt, Vec3f::Zero(), {});
        double projected = 0.0, norm = 0.0;
        for (std::size_t i = 0; i < fluid.count(); ++i) {
            const Vec3f& x = fluid.positions()[i];
            const bool inner = x.x() > 2 * spacing && x.x() < 10 * spacing && x.y() > 2 * spacing &&
                               x.y() < 10 * spacing && x.z() > 2 * spacing && x.z() < 14 * spacing;
            if (inner) {
                const auto wave = static_cast<double>(std::sin(k * x.z()));
                projected += static_cast<double>(fluid.velocities()[i].x()) * wave;
                norm += wave * wave;
            }
        }
        return projected / norm;
    };
    for (const float viscosity : {5e-6f, 2e-5f}) {
        const double lost = (amplitude(0.0f) - amplitude(viscosity)) / static_cast<double>(u);
        const auto expected = static_cast<double>(viscosity * k * k * dt);
        EXPECT_NEAR(lost, expected, 0.2 * expected) << viscosity;
    }
}

/// A block that splashes over a moving capsule, with all forces and an emitter.
struct Busy {
    explicit Busy(const RigidTransform& frame, bool in_vessel = true) : pose(frame), walls(in_vessel) {
        solid = vessel(Vec3f::Zero(), spacing * at(20, 10, 20), pose);
        FluidEmitter emitter;
        emitter.position = pose * Vec3f(15e-3f, 5e-3f, 15e-3f);
        emitter.direction = pose.rotation * Vec3f(0, 0, -1);
        emitter.flow = 1e-6f;
        fluid.set_emitters({&emitter, 1});
        // Not a lattice, which is in unstable equilibrium; and clear of the vessel's edges, where rounding
        // decides which wall is the nearest.
        Random random(8);
        for (int z = 0; z < 10; ++z) {
            for (int y = 0; y < 8; ++y) {
                for (int x = 0; x < 10; ++x) {
                    const Vec3f jitter(random.uniform(), random.uniform(), random.uniform());
                    fluid.add(pose * (spacing * (at(x, y, z) + Vec3f(0.8f, 1.1f, 0.6f) + 0.2f * jitter)));
                }
            }
        }
    }
    void step(int n) {
        MovingCapsule capsule;
        const auto place = [&](int k) {
            return Vec3f(14e-3f - 2e-6f * static_cast<float>(k), -5e-3f, 4e-3f);
        };
        capsule.radius = 2e-3f;
        capsule.a_before = pose * place(n);
        capsule.a = pose * place(n + 1);
        capsule.b_before = pose * (place(n) + Vec3f(0, 20e-3f, 0));
        capsule.b = pose * (place(n + 1) + Vec3f(0, 20e-3f, 0));
        FluidSurroundings surroundings;
        if (walls) {
            surroundings.solid = &solid;
            surroundings.capsules = {&capsule, 1};
        }
        fluid.step(dt, pose.rotation * Vec3f(0, 0, -g), surroundings);
    }
    RigidTransform pose;
    bool walls;
    Fluid fluid{FluidSettings{}, 3};
    DistanceGrid solid;
};

TEST(Fluid, SameBitsForAnyNumberOfThreads) {
    std::vector<Vec3f> first;
    for (const std::size_t threads : {1, 2, 8}) {
        Busy busy{RigidTransform{}};
        eti::test::with_threads(threads, [&] {
            for (int n = 0; n < 200; ++n) {
                busy.step(n);
            }
        });
        ASSERT_GT(busy.fluid.count(), 900u);
        std::vector<Vec3f> state(busy.fluid.positions().begin(), busy.fluid.positions().end());
        state.insert(state.end(), busy.fluid.velocities().begin(), busy.fluid.velocities().end());
        if (first.empty()) {
            first = state;
        }
        ASSERT_EQ(state.size(), first.size());
        EXPECT_EQ(std::memcmp(state.data(), first.data(), state.size() * sizeof(Vec3f)), 0) << threads;
    }
}

TEST(Fluid, SameBitsForAnyInstructionSet) {
    Busy narrow{RigidTransform{}}, wide{RigidTransform{}};
    narrow.fluid.use_avx2(false);
    for (int n = 0; n < 100; ++n) {
        narrow.step(n);
        wide.step(n);
    }
    ASSERT_EQ(narrow.fluid.count(), wide.fluid.count());
    EXPECT_EQ(std::memcmp(narrow.fluid.positions().data(), wide.fluid.positions().data(),
                          wide.fluid.count() * sizeof(Vec3f)),
              0);
}

/// Mean distance [spacings] between the pool's particles in two runs, each in its own frame. (Emitted
/// particles are sampled in directions about an axis that does not rotate with the frame.)
double fluids_apart(const Busy& a, const Busy& b) {
    const auto in_a = by_id(a.fluid), in_b = by_id(b.fluid);
    EXPECT_EQ(in_a.size(), in_b.size());
    double sum = 0.0;
    constexpr std::size_t pool = 800;
    for (std::size_t i = 0; i < pool; ++i) {
        sum += static_cast<double>((a.pose.inverse() * in_a[i] - b.pose.inverse() * in_b[i]).norm());
    }
    return sum / static_cast<double>(pool) / static_cast<double>(spacing);
}

TEST(Fluid, IsInvariantToRigidTransform) {
    // Liquids are chaotic: rounding (2e-6 of a spacing, measured after one step) grows by a factor of e in
    // some seven steps as particles collide. 20 steps make it 20 times larger; the bound is five times that.
    // A grid or a force that depends on the axes would show up at 1e-2.
    const RigidTransform shift = RigidTransform::from(Quatf::Identity(), Vec3f(0.013f, -0.021f, 0.037f));
    const RigidTransform turn =
        RigidTransform::from(Quatf(Eigen::AngleAxisf(1.1f, Vec3f(1, 2, 3).normalized())), Vec3f(0.01f, 0, 0));
    {
        Busy straight(RigidTransform{}, false), shifted(shift, false), turned(turn, false);
        for (int n = 0; n < 20; ++n) {
            straight.step(n);
            shifted.step(n);
            turned.step(n);
        }
        EXPECT_LT(fluids_apart(straight, shifted), 2e-4);
        EXPECT_LT(fluids_apart(straight, turned), 2e-4);
    }
    // In a vessel it grows faster where two walls are equally near and rounding decides between them: ten
    // steps. Rotated, a vessel's grid rounds its edges by up to a node's spacing, half a particle's, for the
    // particles along them, a fifth of all.
    Busy straight(RigidTransform{}), shifted(shift), turned(turn);
    for (int n = 0; n < 10; ++n) {
        straight.step(n);
        shifted.step(n);
        turned.step(n);
    }
    EXPECT_LT(fluids_apart(straight, shifted), 2e-4);
    EXPECT_LT(fluids_apart(straight, turned), 0.1);
    EXPECT_LT((turned.pose.inverse() * centre(turned.fluid) - centre(straight.fluid)).norm(),
              0.02f * spacing);
}

TEST(Fluid, StepsDoNotAllocate) {
    // One thread: oneTBB allocates its own tasks from pools that grow with the threads it starts.
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    Busy busy{RigidTransform{}};
    busy.step(0);
    const long before = eti::test::allocations();
    for (int n = 1; n < 20; ++n) {
        busy.step(n);
    }
    EXPECT_EQ(eti::test::allocations(), before);
}

}  // namespace
}  // namespace eti::pbd
