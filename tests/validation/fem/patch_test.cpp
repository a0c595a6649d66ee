// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The patch test (Irons & Razzaque 1972): an affine motion of the surface is an equilibrium for any mesh.
#include <gtest/gtest.h>

#include "common/math/random.hpp"
#include "tests/support/tetrahedral_body.hpp"

namespace eti {
namespace {

constexpr int cells = 4;
constexpr double patch_cell = 2.5e-3;
constexpr float patch_modulus = 8e3f;

/// A cube whose inner nodes are shifted by up to a fifth of a cell, so that no two tetrahedra are alike.
test::TetrahedralLattice crooked() {
    test::TetrahedralLattice lattice = test::tetrahedral_lattice(cells, cells, cells, patch_cell);
    Random random(1);
    for (Vec3d& x : lattice.position) {
        const Vec3d shift =
            0.2 * patch_cell *
            (2.0 * Vec3d(double{random.uniform()}, double{random.uniform()}, double{random.uniform()}) -
             Vec3d::Ones());
        if (x.minCoeff() > 1e-9 && x.maxCoeff() < cells * patch_cell - 1e-9) {
            x += shift;
        }
    }
    return lattice;
}

/// Largest distance [m] of an inner node from the affine motion, at rest.
double departure(const Eigen::Matrix3d& gradient, float poisson_ratio, float dt) {
    test::TetrahedralBody body(crooked(), patch_modulus, poisson_ratio);
    body.damping = 60.0f;
    pbd::Particles& p = body.particles;
    Random random(2);
    std::vector<std::size_t> inner;
    std::vector<Vec3d> expected;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec3d rest = p.rest[i].cast<double>();
        expected.push_back(gradient * rest + Vec3d(1e-3, -2e-3, 3e-3));
        p.position[i] = expected.back().cast<float>();
        if (rest.minCoeff() > 1e-9 && rest.maxCoeff() < cells * patch_cell - 1e-9) {
            inner.push_back(i);
            // Starts a tenth of a cell away from it and must return.
            p.position[i] += 0.1f * static_cast<float>(patch_cell) *
                             Vec3f(random.normal(), random.normal(), random.normal()).normalized();
        } else {
            p.inverse_mass[i] = 0.0f;
            p.velocity[i].setZero();
        }
    }
    for (float time = 0.0f; time < 0.6f; time += dt) {
        body.substep(dt);
    }
    double worst = 0.0;
    for (const std::size_t i : inner) {
        worst = std::max(worst, (p.position[i].cast<double>() - expected[i]).norm());
    }
    EXPECT_EQ(inner.size(), 27u);
    return worst;
}

// The scheme leaves an error of second order in dt c / h with the speed of pressure waves c: at most 0.4 of
// its square (see Tetrahedra) of the displacement that the strain of 0.3 causes over a cell. A quarter of the
// substep leaves a sixteenth. A rotation has no strain: rounding of 1e-9 m remains, amplified as elasticity
// responds less.
TEST(PatchTest, AffineSurfaceMotionIsEquilibrium) {
    Eigen::Matrix3d stretch, shear, turn;
    stretch << 1.3, 0, 0, 0, 0.9, 0, 0, 0, 0.85;
    shear << 1.0, 0.3, 0, 0, 1.0, 0.2, 0.1, 0, 1.0;
    turn = Eigen::AngleAxisd(0.8, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
    constexpr double fine_dt = 1.0 / 5760.0;
    for (const float nu : {0.3f, 0.45f}) {
        const double n = double{nu};
        const double speed_squared = double{patch_modulus} * (1 - n) / ((1 + n) * (1 - 2 * n) * 1000.0);
        const double courant_squared = fine_dt * fine_dt * speed_squared / (patch_cell * patch_cell);
        for (const Eigen::Matrix3d& gradient : {stretch, shear, Eigen::Matrix3d(turn * stretch)}) {
            const double coarse = departure(gradient, nu, static_cast<float>(4.0 * fine_dt));
            const double fine = departure(gradient, nu, static_cast<float>(fine_dt));
            EXPECT_LT(fine, 0.4 * courant_squared * 0.3 * patch_cell) << nu;
            EXPECT_GT(coarse / fine, 12.0) << nu;
            EXPECT_LT(coarse / fine, 20.0) << nu;
        }
        EXPECT_LT(departure(turn, nu, static_cast<float>(4.0 * fine_dt)), 3e-8) << nu;
        EXPECT_LT(departure(turn, nu, static_cast<float>(fine_dt)), 16.0 * 3e-8) << nu;
    }
}

}  // namespace
}  // namespace eti
