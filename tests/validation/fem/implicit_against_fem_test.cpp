// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "server/pbd/implicit/implicit_mesh.hpp"
#include "tests/support/tetrahedral_lattice.hpp"
#include "tests/validation/fem/static_solver.hpp"

namespace eti::fem {
namespace {

constexpr double implicit_cell = 2.5e-3;
constexpr double implicit_modulus = 5e3;
constexpr double implicit_density = 1000.0;
constexpr float implicit_dt = 1.0f / 180.0f;

/// A block of 20 x 10 x 10 mm, one solve per step, without damping except that of implicit Euler and
/// `damping`.
struct Block {
    test::TetrahedralLattice lattice = test::tetrahedral_lattice(8, 4, 4, implicit_cell);
    pbd::Particles particles;
    pbd::ImplicitMesh mesh;

    /// `held` decides by rest position whether a particle is fixed.
    template <class Held>
    Block(double poisson_ratio, const Held& held) {
        pbd::Particles& p = particles;
        p.resize(lattice.position.size());
        std::vector<double> mass(p.size(), 0.0);
        for (const auto& corners : lattice.tetrahedra) {
            for (const std::uint32_t i : corners) {
                mass[i] += implicit_density * std::pow(implicit_cell, 3) / 24.0;
            }
        }
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.rest[i] = p.position[i] = p.predicted[i] = lattice.position[i].cast<float>();
            p.inverse_mass[i] = held(lattice.position[i]) ? 0.0f : static_cast<float>(1.0 / mass[i]);
        }
        const std::vector<float> moduli(lattice.tetrahedra.size(), static_cast<float>(implicit_modulus));
        mesh.configure({{lattice.tetrahedra, moduli, static_cast<float>(poisson_ratio)}, {}}, p,
                       p.inverse_mass);
    }

    void predict(const Vec3f& gravity) {
        pbd::Particles& p = particles;
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] += p.inverse_mass[i] > 0.0f ? Vec3f(implicit_dt * gravity) : Vec3f(Vec3f::Zero());
            p.predicted[i] = p.position[i];
        }
    }
    void solve(float damping) {
        pbd::Particles& p = particles;
        mesh.solve(p, implicit_dt);
        const float keep = std::exp(-damping * implicit_dt) / implicit_dt;
        for (std::size_t i = 0; i < p.size(); ++i) {
            p.velocity[i] = keep * (p.predicted[i] - p.position[i]);
            p.position[i] = p.predicted[i];
        }
    }
};

Problem implicit_problem(const test::TetrahedralLattice& lattice, double poisson_ratio) {
    Problem problem;
    problem.rest = lattice.position;
    problem.tetrahedra = lattice.tetrahedra;
    problem.youngs_modulus = implicit_modulus;
    problem.poisson_ratio = poisson_ratio;
    return problem;
}

// Static results equal those of finite elements up to float rounding. A strain is a difference of coordinates
// of 2 cm over a cell, rounded by 6e-8 x 2 cm / 2.5 mm = 5e-7. Bending strains the block by 2 % at most under
// the least load here. Pressure multiplies an error of volume by 1 / (1 - 2 nu) = 50 for a ratio of 0.49:
// 1e-3.
class ImplicitSag : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(ImplicitSag, MatchesFiniteElements) {
    const auto [nu, gravity] = GetParam();
    const auto held = [](const Vec3d& rest) { return rest.x() < 1e-9; };
    Block block(nu, held);
    Problem problem = implicit_problem(block.lattice, nu);
    problem.gravity = {0, 0, -gravity};
    for (std::uint32_t i = 0; i < block.lattice.position.size(); ++i) {
        if (held(block.lattice.position[i])) {
            problem.hold(i);
        }
    }
    const Solution expected = solve(problem);
    ASSERT_TRUE(expected.converged) << expected.residual;
    // A nearly incompressible body needs more iterations to converge within these two seconds.
    block.mesh.settings.iterations = nu > 0.46 ? 60 : 8;
    for (int k = 0; k < 360; ++k) {
        block.predict({0, 0, -static_cast<float>(gravity)});
        block.solve(60.0f);
    }
    double squared = 0.0;
    double moved = 0.0;
    for (std::size_t i = 0; i < block.particles.size(); ++i) {
        squared += (block.particles.position[i].cast<double>() - expected.position[i]).squaredNorm();
        moved += (expected.position[i] - block.lattice.position[i]).squaredNorm();
    }
    RecordProperty("relative_displacement_error", std::to_string(std::sqrt(squared / moved)));
    EXPECT_LT(std::sqrt(squared / moved), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(PoissonRatiosAndLoads, ImplicitSag,
                         testing::Combine(testing::Values(0.3, 0.45, 0.49),
                                          testing::Values(2.0, 9.81, 30.0)));

/// The block held at its top, on a plane that has risen by `depth` [m] and moves along x with `speed` [m/s].
struct PressedBlock {
    static constexpr double top = 4 * implicit_cell;
    static constexpr float depth = 1e-3f;
    Block block{0.45, [](const Vec3d& rest) { return rest.z() > top - 1e-9; }};
    std::vector<std::uint32_t> bottom;

    PressedBlock() {
        for (std::uint32_t i = 0; i < block.particles.size(); ++i) {
            if (block.lattice.position[i].z() < 1e-9) {
                bottom.push_back(i);
            }
        }
    }

    void step(float friction, float speed) {
        pbd::Particles& p = block.particles;
        block.predict(Vec3f::Zero());
        std::vector<pbd::MeshContact> now;
        for (const std::uint32_t i : bottom) {
            pbd::MeshContact c;
            c.particle = {i};
            c.normal = Vec3f::UnitZ();
            c.gap = p.predicted[i].z() - depth;
            c.slip = c.across(p.predicted[i] - p.position[i] - Vec3f(speed * implicit_dt, 0.0f, 0.0f));
            c.friction = friction;
            for (const pbd::MeshContact& last : block.mesh.contacts) {
                if (last.particle == c.particle) {
                    c.force = last.force;
                    c.slip += last.slip;
                }
            }
            now.push_back(c);
        }
        block.mesh.contacts = now;
        block.solve(60.0f);
    }

    [[nodiscard]] Vec3d force() const {
        Vec3d sum = Vec3d::Zero();
        for (const pbd::MeshContact& c : block.mesh.contacts) {
            sum += c.force.cast<double>();
        }
        return sum;
    }
};

/// Force of the plane on the block by finite elements whose lowest vertices rise by its depth; laterally they
/// stick or are free.
Vec3d pressed_by_elements(bool sticks) {
    const PressedBlock pressed;
    Problem problem = implicit_problem(pressed.block.lattice, 0.45);
    for (std::uint32_t i = 0; i < problem.rest.size(); ++i) {
        if (problem.rest[i].z() > PressedBlock::top - 1e-9) {
            problem.hold(i);
        }
    }
    for (const std::uint32_t i : pressed.bottom) {
        if (sticks) {
            problem.hold(i, {0, 0, double{PressedBlock::depth}});
        } else {
            problem.held.push_back({i, 2, double{PressedBlock::depth}});
        }
    }
    const Solution solution = solve(problem);
    EXPECT_TRUE(solution.converged) << solution.residual;
    Eigen::VectorXd x(3 * static_cast<Eigen::Index>(problem.rest.size()));
    for (std::size_t i = 0; i < problem.rest.size(); ++i) {
        x.segment<3>(3 * static_cast<Eigen::Index>(i)) = solution.position[i];
    }
    const Eigen::VectorXd slope = Potential(problem).gradient(x);
    Vec3d force = Vec3d::Zero();
    for (const std::uint32_t i : pressed.bottom) {
        force += slope.segment<3>(3 * static_cast<Eigen::Index>(i));
    }
    return force;
}

TEST(ImplicitContact, FrictionlessForceMatchesFiniteElements) {
    // 1e-3 by float rounding, as above.
    PressedBlock pressed;
    for (int k = 0; k < 540; ++k) {
        pressed.step(0.0f, 0.0f);
    }
    const Vec3d expected = pressed_by_elements(false);
    EXPECT_LT((pressed.force() - expected).norm(), 1e-3 * expected.norm()) << pressed.force();
    for (const std::uint32_t i : pressed.bottom) {
        EXPECT_NEAR(pressed.block.particles.position[i].z(), PressedBlock::depth, 1e-6f);
    }
}

TEST(ImplicitContact, SlidingFrictionMatchesCoulomb) {
    // Closed form: the tangential force is the coefficient times the normal force, along the plane's motion.
    // Mean over a second, during which points creep sideways because the lattice lacks mirror symmetry: 5 %.
    constexpr float friction = 0.2f;
    PressedBlock pressed;
    Vec3d mean = Vec3d::Zero();
    for (int k = 0; k < 540; ++k) {
        pressed.step(friction, 0.02f);
        mean += k < 360 ? Vec3d(Vec3d::Zero()) : Vec3d(pressed.force() / 180.0);
    }
    const double bound = double{friction} * mean.z();
    EXPECT_NEAR(mean.x(), bound, 0.01 * bound);
    EXPECT_NEAR(mean.y(), 0.0, 0.05 * bound);
}

TEST(ImplicitContact, StickingMatchesBondedReference) {
    // With a coefficient of 10 no point slides: the holding force grows until the point is back where it
    // stuck.
    PressedBlock pressed;
    for (int k = 0; k < 540; ++k) {
        pressed.step(10.0f, 0.0f);
    }
    const Vec3d glued = pressed_by_elements(true);
    const Vec3d free = pressed_by_elements(false);
    EXPECT_LT(std::fabs(pressed.force().z() - glued.z()), 0.01 * (glued.z() - free.z())) << pressed.force();
}

}  // namespace
}  // namespace eti::fem
