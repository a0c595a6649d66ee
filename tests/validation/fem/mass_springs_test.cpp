// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/support/mass_springs.hpp"

#include <gtest/gtest.h>

namespace eti::test {
namespace {

constexpr double springs_modulus = 8e3;
constexpr double springs_cell = 2e-3;

/// Work [J] of the springs' forces over a small uniform strain of a block of 4 x 4 x 4 cells.
double stored(const Eigen::Matrix3d& strain) {
    const TetrahedralLattice lattice = tetrahedral_lattice(4, 4, 4, springs_cell);
    const MassSprings springs(lattice, springs_modulus);
    pbd::Particles p;
    p.resize(lattice.position.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
        p.position[i] = (lattice.position[i] + strain * lattice.position[i]).cast<float>();
        p.inverse_mass[i] = 1.0f;
    }
    springs.accelerate(p, 1.0f);  // with dt = 1 and unit mass, velocities equal forces
    double work = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        work -= 0.5 * p.velocity[i].cast<double>().dot(strain * lattice.position[i]);
    }
    return work;
}

/// The same for Hooke's solid.
double expected(const Eigen::Matrix3d& strain) {
    constexpr double nu = MassSprings::poisson_ratio;
    const double mu = springs_modulus / (2.0 * (1.0 + nu));
    const double lambda = springs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    const double volume = std::pow(4.0 * springs_cell, 3);
    return volume * (0.5 * lambda * std::pow(strain.trace(), 2) + mu * strain.squaredNorm());
}

TEST(MassSprings, StoreEnergyOfIsotropicSolid) {
    // Strains of 1 % change lengths to second order by the same share of the energy; float positions leave
    // 1e-7 over 1e-2 times the cell's share of the block.
    constexpr double e = 0.01;
    Eigen::Matrix3d along = Eigen::Matrix3d::Zero();
    along(0, 0) = e;
    Eigen::Matrix3d shear = Eigen::Matrix3d::Zero();
    shear(0, 1) = shear(1, 0) = e;
    const Eigen::Matrix3d swell = e * Eigen::Matrix3d::Identity();
    Eigen::Matrix3d mixed;
    mixed << e, 0.5 * e, 0.0, 0.5 * e, -e, -0.3 * e, 0.0, -0.3 * e, 0.4 * e;
    for (const Eigen::Matrix3d& strain : {along, shear, swell, mixed}) {
        EXPECT_NEAR(stored(strain) / expected(strain), 1.0, 0.02) << strain;
    }
}

}  // namespace
}  // namespace eti::test
