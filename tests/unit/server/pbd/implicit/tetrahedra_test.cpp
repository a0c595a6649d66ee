// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/implicit/tetrahedra.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <set>

#include "common/math/random.hpp"
#include "server/pbd/implicit/neo_hookean.hpp"
#include "tests/support/tetrahedral_body.hpp"

namespace eti::pbd {
namespace {

using Eigen::Matrix3d;
using test::tetrahedral_lattice;
using test::TetrahedralBody;
using Corners = Eigen::Matrix<double, 3, 4>;

Matrix3d edges(const Corners& x) {
    return x.rightCols<3>().colwise() - x.col(0);
}

/// Corners about a millimetre apart, in either orientation, far from flat.
Corners random_corners(Random& random) {
    for (;;) {
        Corners x;
        for (double& coordinate : x.reshaped()) {
            coordinate = 1e-3 * static_cast<double>(random.normal());
        }
        if (std::fabs(edges(x).determinant()) > 1e-10) {
            return x;
        }
    }
}

RestTetrahedron<double> rest_of(const Corners& x) {
    const Matrix3d q = edges(x).inverse();
    const Matrix3d m = q * q.transpose();
    return {{m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)}, q.determinant()};
}

NeoHookean<double> neo_hookean_at(const Corners& corners, const RestTetrahedron<double>& rest) {
    double x[4][3];
    for (int v = 0; v < 4; ++v) {
        for (int i = 0; i < 3; ++i) {
            x[v][i] = corners(i, v);
        }
    }
    NeoHookean<double> out;
    neo_hookean(x, rest, out);
    return out;
}

TEST(NeoHookean, ConstraintsMatchDeformationGradient) {
    // Reference: F = D Q by Eigen. Double precision; the shapes' condition numbers stay below about 1e3, and
    // the metric squares them: 1e-16 * 1e6, times a few operations.
    Random random(1);
    for (int trial = 0; trial < 200; ++trial) {
        const Corners rest = random_corners(random);
        const Corners now = random_corners(random);
        const Matrix3d f = edges(now) * edges(rest).inverse();
        const NeoHookean<double> c = neo_hookean_at(now, rest_of(rest));
        EXPECT_NEAR(c.trace, f.squaredNorm(), 1e-9 * f.squaredNorm());
        EXPECT_NEAR(c.determinant, f.determinant(), 1e-9 * std::pow(f.norm(), 3));
    }
}

TEST(NeoHookean, GradientsMatchFiniteDifferences) {
    // Central differences with a step of 1e-8 m on lengths of 1e-3 m: both constraints are polynomials of
    // third order or less, so the truncation is (1e-5)^2 and the rounding 1e-16 / 1e-5 of the largest
    // term, which can exceed the gradient a hundred times: 1e-8.
    constexpr double step = 1e-8;
    Random random(2);
    for (int trial = 0; trial < 100; ++trial) {
        const RestTetrahedron<double> rest = rest_of(random_corners(random));
        const Corners x = random_corners(random);
        const NeoHookean<double> c = neo_hookean_at(x, rest);
        Corners deviatoric;
        Corners hydrostatic;
        Corners deviatoric_difference;
        Corners hydrostatic_difference;
        for (int v = 0; v < 4; ++v) {
            for (int i = 0; i < 3; ++i) {
                Corners up = x;
                Corners down = x;
                up(i, v) += step;
                down(i, v) -= step;
                const NeoHookean<double> above = neo_hookean_at(up, rest);
                const NeoHookean<double> below = neo_hookean_at(down, rest);
                deviatoric(i, v) = c.deviatoric[v][i];
                hydrostatic(i, v) = c.hydrostatic[v][i];
                deviatoric_difference(i, v) = 0.5 * (above.trace - below.trace) / (2.0 * step);
                hydrostatic_difference(i, v) = (above.determinant - below.determinant) / (2.0 * step);
            }
        }
        EXPECT_LT((deviatoric - deviatoric_difference).norm(), 1e-8 * deviatoric.norm());
        EXPECT_LT((hydrostatic - hydrostatic_difference).norm(), 1e-8 * hydrostatic.norm());
    }
}

TEST(Tetrahedra, OfSameColourShareNoParticle) {
    const TetrahedralBody body(tetrahedral_lattice(7, 5, 4, 2e-3), 8e3f, 0.45f);
    std::size_t found = 0;
    for (std::size_t colour = 0; colour < body.tetrahedra.colours(); ++colour) {
        std::set<std::uint32_t> seen;
        for (const Tetrahedra::Block& block : body.tetrahedra.blocks(colour)) {
            for (std::size_t lane = 0; lane < Tetrahedra::lanes; ++lane) {
                found += block.stiffness[lane] > 0.0f ? 1 : 0;  // zero: padding of the block
                for (const auto& corner : block.corner) {
                    EXPECT_TRUE(seen.insert(corner[lane]).second) << colour;
                }
            }
        }
    }
    EXPECT_EQ(found, body.lattice.tetrahedra.size());
}

TEST(Tetrahedra, FlatElementsHaveNoStiffness) {
    Particles p;
    p.resize(4);
    p.rest = {{0, 0, 0}, {1e-3f, 0, 0}, {0, 1e-3f, 0}, {1e-3f, 1e-3f, 0}};
    Tetrahedra tetrahedra;
    tetrahedra.configure({{{0, 1, 2, 3}}, {8e3f}, 0.45f}, p);
    EXPECT_EQ(tetrahedra.blocks(0)[0].stiffness[0], 0.0f);
    p.rest[3] = {0, 0, 1e-3f};
    tetrahedra.set_rest(p);
    // mu V = E / (2 (1 + nu)) a^3 / 6
    EXPECT_FLOAT_EQ(tetrahedra.blocks(0)[0].stiffness[0], 8e3f / 2.9f * 1e-9f / 6.0f);
}

TEST(Tetrahedra, SetYoungsModulusMatchesConstruction) {
    const TetrahedralBody soft(tetrahedral_lattice(4, 4, 4, 2e-3), 5e3f, 0.45f);
    TetrahedralBody body(tetrahedral_lattice(4, 4, 4, 2e-3), 8e3f, 0.45f);
    body.tetrahedra.set_youngs_modulus(std::vector<float>(body.lattice.tetrahedra.size(), 5e3f));
    for (std::size_t colour = 0; colour < body.tetrahedra.colours(); ++colour) {
        const auto expected = soft.tetrahedra.blocks(colour);
        const auto found = body.tetrahedra.blocks(colour);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t b = 0; b < found.size(); ++b) {
            EXPECT_TRUE(std::ranges::equal(found[b].stiffness, expected[b].stiffness));
        }
    }
}

}  // namespace
}  // namespace eti::pbd
