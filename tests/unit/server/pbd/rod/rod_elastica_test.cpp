// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/elastica.hpp"
#include "tests/support/rod_fixture.hpp"

namespace eti {
namespace {

constexpr float elastica_dt = 1.0f / 720.0f;

// A cantilever under a small tip force bends by F L^3 / 3 EI: the reference solver against the closed
// form. Next order: the tip's slope F L^2 / 2 EI squared.
TEST(Elastica, SmallLoadGivesTheBeamFormula) {
    const double force = 1e-4;
    const test::ElasticaEnd end = test::solve({.length = 0.16, .stiffness = 1.7e-4, .tip_force = {0, force}});
    const double expected = force * std::pow(0.16, 3) / (3 * 1.7e-4);
    const double slope = force * 0.16 * 0.16 / (2 * 1.7e-4);
    EXPECT_NEAR(end.tip.y(), expected, expected * slope * slope);
    EXPECT_NEAR(end.clamp_moment, force * 0.16, force * 0.16 * slope * slope);
}

struct Load {
    float youngs_modulus;  // [Pa]
    float tip_force;       // [N], along -y
    bool weight;
    bool curved;
};

class Cantilever : public testing::TestWithParam<Load> {};

/// Position of the tip in the z-y plane once settled.
Eigen::Vector2d settled_tip(const Load& load, int segments) {
    Tube tube = test::cantilever();
    tube.youngs_modulus = load.youngs_modulus;
    if (load.curved) {
        tube.curve_radius = 0.14f;
    }
    pbd::Rod rod(tube, test::damped(segments), {});
    const Vec3f gravity = load.weight ? Vec3f(0.0f, -9.81f, 0.0f) : Vec3f(Vec3f::Zero());
    test::run(rod, test::settled, elastica_dt, gravity, {}, {0.0f, -load.tip_force, 0.0f});
    return {double{rod.tip().z()}, double{rod.tip().y()}};
}

Eigen::Vector2d reference_tip(const Load& load) {
    Tube tube = test::cantilever();
    tube.youngs_modulus = load.youngs_modulus;
    const double weight = load.weight ? -9.81 * test::line_density(tube, {}) : 0.0;
    return test::solve({.length = double{tube.length},
                        .stiffness = double{tube.bending_stiffness()},
                        .rest_curvature = load.curved ? 1.0 / 0.14 : 0.0,
                        .tip_force = {0.0, -double{load.tip_force}},
                        .weight = {0.0, weight}})
        .tip;
}

// Joints lie in the middle of equal pieces, so curvature is integrated by the midpoint rule. For the linear
// cantilever that errs by h^2 / 4 L^2 of the deflection. Large rotations multiply it by a factor of order
// one, and deflections are below L: h^2 / 2 L bounds the error. 0.1 mm remain for settling and the tube's
// real stretch (F L / EA < 0.2 mm at 0.1 N: 0.1 N 0.16 m / 100 N).
TEST_P(Cantilever, BendsLikeTheElastica) {
    const Eigen::Vector2d expected = reference_tip(GetParam());
    for (const int segments : {16, 32}) {
        const Eigen::Vector2d found = settled_tip(GetParam(), segments);
        const double h = 0.16 / (segments - 0.5);
        EXPECT_LT((found - expected).norm(), h * h / (2 * 0.16) + 1e-4)
            << segments << " segments, expected " << expected.transpose() << ", found " << found.transpose();
    }
    // The loads are significant: the tip moves by many times the tolerance.
    const Eigen::Vector2d unloaded =
        reference_tip({GetParam().youngs_modulus, 0.0f, false, GetParam().curved});
    EXPECT_GT((expected - unloaded).norm(), 0.004);
}

// E of 4.4, 15 and 44 MPa: EI of 0.5, 1.7 and 5 e-4 N m^2.
INSTANTIATE_TEST_SUITE_P(Loads, Cantilever,
                         testing::Values(Load{4.4e6f, 0.0f, true, false}, Load{15e6f, 0.0f, true, false},
                                         Load{44e6f, 0.0f, true, false}, Load{15e6f, 0.05f, false, false},
                                         Load{15e6f, 0.05f, true, true}, Load{4.4e6f, 0.015f, false, true}));

// Second order: halving the segments' length divides the error by four.
TEST(RodConvergence, ErrorIsSecondOrderInSegmentLength) {
    const Load load{15e6f, 0.02f, true, false};
    const Eigen::Vector2d expected = reference_tip(load);
    const double coarse = (settled_tip(load, 6) - expected).norm();
    const double fine = (settled_tip(load, 12) - expected).norm();
    // (11.5 / 5.5)^2 = 4.4, and the next order a few per cent.
    EXPECT_NEAR(coarse / fine, 4.4, 0.5);
}

TEST(RodStiffness, DoublingHalvesSmallDeflections) {
    const float force = 5e-4f;
    const auto deflection = [&](float modulus) {
        return -settled_tip({modulus, force, false, false}, 32).y();
    };
    // Relative deviation from linearity: the square of the tip's slope, (F L^2 / 2 EI)^2 = 1.4e-3.
    EXPECT_NEAR(deflection(15e6f) / deflection(30e6f), 2.0, 2.0 * 1.5e-3);
}

// At rest the hand carries the rod's weight and its moment about the grip.
class RodGrip : public testing::TestWithParam<float> {};  // grip from the tip [m]

TEST_P(RodGrip, WrenchIsTheWeightAtRest) {
    Tube tube;
    tube.grip_from_tip = GetParam();
    const pbd::RodSettings settings = test::damped(32);
    const RigidTransform grip{Quatf(Eigen::AngleAxisf(0.7f, Vec3f(0.6f, 0.0f, 0.8f))),
                              Vec3f(0.1f, 0.2f, 0.3f)};
    pbd::Rod rod(tube, settings, grip);
    const Vec3f gravity(0.0f, -9.81f, 0.0f);
    test::run(rod, test::settled, elastica_dt, gravity, grip);
    const pbd::GripWrench wrench = rod.grip_wrench();
    const double mass =
        test::line_density(tube, settings) * double{tube.length} + double{settings.connector_mass};
    // e^-15 of the initial motion and float32 of the report.
    EXPECT_LT((wrench.force - static_cast<float>(mass) * gravity).norm(),
              1e-4f * static_cast<float>(mass) * 9.81f);
    Vec3d torque = Vec3d::Zero();
    for (std::size_t i = 0; i < rod.size(); ++i) {
        const double own = test::line_density(tube, settings) * double{rod.length(i)} +
                           (i == 0 ? double{settings.connector_mass} : 0.0);
        torque += (rod.point(i, 0.5f) - grip.translation).cast<double>().cross(own * gravity.cast<double>());
    }
    EXPECT_LT((wrench.torque.cast<double>() - torque).norm(), 1e-4 * mass * 9.81 * 0.1);
}

// At the middle of a segment, and where the held segment extends farther ahead of the grip than behind it.
INSTANTIATE_TEST_SUITE_P(Grips, RodGrip, testing::Values(0.10f, 0.1585f));

// First bending mode of a cantilever: w = 1.8751^2 sqrt(E I / (m L^4)) (Euler-Bernoulli). Implicit Euler
// lowers a frequency by about (w dt)^2 / 3 and damps the amplitude by w^2 dt / 2 per second. The
// discretisation changes the stiffness by h^2 / 4 L^2; a segment's own inertia and the clamped connector are
// negligible.
TEST(RodDynamics, FirstModeHasTheBeamsFrequency) {
    const Tube tube = test::cantilever();
    pbd::RodSettings settings;
    settings.velocity_damping = 0.0f;
    settings.retardation_time = 0.0f;
    pbd::Rod rod(tube, settings, {});
    const float fine = 1.0f / 5760.0f;
    // A short push, then free oscillation: the lowest mode outlasts the others, which implicit Euler damps as
    // the square of their frequency.
    test::run(rod, 0.05, fine, Vec3f::Zero(), {}, {0.0f, 0.003f, 0.0f});
    test::run(rod, 0.3, fine, Vec3f::Zero(), {});
    std::vector<double> crossings;
    double before = double{rod.tip().y()};
    for (int i = 1; crossings.size() < 5 && i < 20000; ++i) {
        test::run(rod, double{fine}, fine, Vec3f::Zero(), {});
        const double now = double{rod.tip().y()};
        if (before < 0.0 && now >= 0.0) {
            crossings.push_back((i - now / (now - before)) * double{fine});
        }
        before = now;
    }
    ASSERT_EQ(crossings.size(), 5u);
    const double found = 4.0 * 2.0 * 3.14159265358979 / (crossings.back() - crossings.front());
    const double expected = 1.875104 * 1.875104 *
                            std::sqrt(double{tube.bending_stiffness()} / (test::line_density(tube, settings) *
                                                                          std::pow(double{tube.length}, 4)));
    EXPECT_NEAR(found, expected, 0.01 * expected);
}

}  // namespace
}  // namespace eti
