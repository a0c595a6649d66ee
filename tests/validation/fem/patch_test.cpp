// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The patch test (Irons & Razzaque 1972): an affine motion of the surface is an equilibrium for any mesh.
#include <gtest/gtest.h>

#include "common/math/random.hpp"
#include "server/pbd/implicit/implicit_mesh.hpp"
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
double departure(const Eigen::Matrix3d& gradient, float poisson_ratio) {
    test::TetrahedralBody body(crooked(), patch_modulus, poisson_ratio);
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
        }
    }
    pbd::ImplicitMesh mesh;
    const std::vector<float> moduli(body.lattice.tetrahedra.size(), patch_modulus);
    mesh.configure({{body.lattice.tetrahedra, moduli, poisson_ratio}, {}}, p, p.inverse_mass);
    constexpr float dt = 1.0f / 180.0f;
    for (int step = 0; step < 108; ++step) {
        p.predicted = p.position;
        mesh.solve(p, dt);
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] = std::exp(-60.0f * dt) / dt * (p.predicted[i] - p.position[i]);
        }
        p.position = p.predicted;
    }
    double worst = 0.0;
    for (const std::size_t i : inner) {
        worst = std::max(worst, (p.position[i].cast<double>() - expected[i]).norm());
    }
    EXPECT_EQ(inner.size(), 27u);
    return worst;
}

// The implicit method's equilibrium is that of its elements. Coordinates of 2 cm are rounded by 1e-9 m, and
// pressure multiplies an error of volume by up to 1 / (1 - 2 nu) = 10.
TEST(PatchTest, AffineSurfaceMotionIsEquilibrium) {
    Eigen::Matrix3d stretch, shear, turn;
    stretch << 1.3, 0, 0, 0, 0.9, 0, 0, 0, 0.85;
    shear << 1.0, 0.3, 0, 0, 1.0, 0.2, 0.1, 0, 1.0;
    turn = Eigen::AngleAxisd(0.8, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
    for (const float nu : {0.3f, 0.45f}) {
        for (const Eigen::Matrix3d& gradient : {stretch, shear, turn, Eigen::Matrix3d(turn * stretch)}) {
            EXPECT_LT(departure(gradient, nu), 1e-8) << nu;
        }
    }
}

}  // namespace
}  // namespace eti
