// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/soft/cluster_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "server/pbd/soft/soft_body.hpp"
#include "tests/support/lattice_clusters.hpp"

namespace eti::pbd {
namespace {

constexpr ClusterLoad loads[] = {ClusterLoad::traction, ClusterLoad::indentation, ClusterLoad::tongue};

TEST(ClusterCalibration, GrowsWithTargetModulusUpToLimit) {
    for (const ClusterLoad load : loads) {
        for (const float spacing : {1e-3f, 2e-3f, 5e-3f}) {
            const ClusterBody body{.spacing = spacing, .load = load};
            CalibratedModulus before;
            for (float wanted = 10.0f; wanted < 1e8f; wanted *= 1.1f) {
                const CalibratedModulus now = calibrated_modulus(body, wanted);
                ASSERT_GE(now.input_modulus, before.input_modulus) << wanted;
                ASSERT_TRUE(now.reached ? now.input_modulus > before.input_modulus : now.measured < wanted)
                    << wanted;
                ASSERT_FALSE(now.reached && !before.reached) << wanted;
                before = now;
            }
            EXPECT_FALSE(before.reached);
            EXPECT_TRUE(std::isfinite(before.input_modulus));
        }
    }
}

/// Young's modulus [Pa] of a bar of clusters, `across` spacings thick and four times as long, held at one end
/// and pulled at the other with a traction of 3 % of `expected`.
double bar_modulus(int across, const ClusterBody& body, float input_modulus, double expected) {
    const test::TetrahedralLattice lattice =
        test::tetrahedral_lattice(4 * across, across, across, static_cast<double>(body.spacing));
    const std::vector<double> mass = test::node_share(lattice, static_cast<double>(body.density));
    SoftBody soft;
    soft.settings.damping = 40.0f;  // [1/s], near critical for the slowest wave along the bar
    Particles& p = soft.particles;
    p.resize(mass.size());
    for (std::size_t i = 0; i < mass.size(); ++i) {
        p.rest[i] = lattice.position[i].cast<float>();
        p.inverse_mass[i] = lattice.position[i].x() < 1e-9 ? 0.0f : static_cast<float>(1.0 / mass[i]);
    }
    soft.shapes.configure(test::lattice_clusters(lattice, mass, test::node_share(lattice, 1.0),
                                                 static_cast<double>(input_modulus), test::patient_radius),
                          p);
    soft.reset();
    const double stress = 0.03 * expected;
    const std::vector<Vec3d> force = test::end_traction(lattice, lattice.nx, {stress, 0, 0});
    for (float time = 0.0f; time < 2.0f; time += body.substep) {
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] += body.substep * p.inverse_mass[i] * force[i].cast<float>();
        }
        soft.predict(body.substep, 1.0f);
        soft.project(body.substep);
        soft.finish(body.substep);
    }
    const auto section = [&](int x) {
        double sum = 0.0;
        for (int z = 0; z <= across; ++z) {
            for (int y = 0; y <= across; ++y) {
                sum += static_cast<double>(p.position[lattice.index(x, y, z)].x());
            }
        }
        return sum / ((across + 1) * (across + 1));
    };
    return stress / ((section(3 * across) - section(across)) / (2.0 * across * lattice.cell) - 1.0);
}

// Bars six spacings thick, which the table interpolates. The bound: the law deviates from the measured bars
// by 1 %, the interpolation between four and eight spacings (c 0.942 and 0.856, convex) by less than 1 %, and
// the strain of 3 % is treated as small.
class Bars : public testing::TestWithParam<std::tuple<float, float, float>> {};

TEST_P(Bars, HaveThePredictedModulus) {
    const auto [spacing, rate, wanted] = GetParam();
    const ClusterBody body{.spacing = spacing,
                           .substep = 1.0f / rate,
                           .thickness = 6.0f * spacing,
                           .load = ClusterLoad::traction};
    const CalibratedModulus m = calibrated_modulus(body, wanted);
    const double measured = bar_modulus(6, body, m.input_modulus, static_cast<double>(m.measured));
    EXPECT_NEAR(measured, static_cast<double>(m.measured), 0.03 * static_cast<double>(m.measured))
        << m.input_modulus << " put in";
}

INSTANTIATE_TEST_SUITE_P(SpacingsRatesModuli, Bars,
                         testing::Values(std::tuple(2e-3f, 1440.0f, 8e3f), std::tuple(2e-3f, 1440.0f, 3e3f),
                                         std::tuple(1.5e-3f, 1000.0f, 4e3f), std::tuple(3e-3f, 900.0f, 12e3f),
                                         std::tuple(1e-3f, 1440.0f, 8e3f)));  // the last is clamped

}  // namespace
}  // namespace eti::pbd
