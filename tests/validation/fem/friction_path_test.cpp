// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/fem/friction_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/math/random.hpp"
#include "tests/support/tetrahedral_lattice.hpp"
#include "tests/support/uniaxial_stretch.hpp"

namespace eti::fem {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::VectorXd;
using test::tetrahedral_lattice;
using test::TetrahedralLattice;

constexpr double path_modulus = 8e3;

/// The half-space behind a plane.
class Plane : public Solid {
  public:
    explicit Plane(const Vec3d& normal = Vec3d::UnitZ(), double height = 0.0)
        : normal_(normal), height_(height) {}
    [[nodiscard]] Sample sample(const Vec3d& point) const override {
        return {point.dot(normal_) - height_, normal_, Eigen::Matrix3d::Zero()};
    }

  private:
    Vec3d normal_;
    double height_;
};

Isometry3d moved(const Vec3d& by) {
    Isometry3d out = Isometry3d::Identity();
    out.translation() = by;
    return out;
}

Vec3d sum(const std::vector<Vec3d>& of) {
    Vec3d out = Vec3d::Zero();
    for (const Vec3d& v : of) {
        out += v;
    }
    return out;
}

PathProblem path_problem(const TetrahedralLattice& lattice, double poisson_ratio) {
    PathProblem problem;
    problem.body.rest = lattice.position;
    problem.body.tetrahedra = lattice.tetrahedra;
    problem.body.youngs_modulus = path_modulus;
    problem.body.poisson_ratio = poisson_ratio;
    return problem;
}

std::vector<std::uint32_t> at_height(const TetrahedralLattice& lattice, double z) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < lattice.position.size(); ++i) {
        if (std::fabs(lattice.position[i].z() - z) < 1e-9) {
            out.push_back(i);
        }
    }
    return out;
}

/// A block of 2 mm cubes fixed to a floor, with a skin of 1 mm balls, under a blade along x.
PathProblem block_under_blade(int nx, int ny, int nz, double friction, bool edges) {
    const TetrahedralLattice lattice = tetrahedral_lattice(nx, ny, nz, 2e-3);
    PathProblem problem = path_problem(lattice, 0.45);
    for (const std::uint32_t i : at_height(lattice, 0.0)) {
        problem.body.hold(i);
    }
    problem.radius.assign(lattice.position.size(), 1e-3);
    problem.points = at_height(lattice, nz * 2e-3);
    for (std::size_t n = 0; edges && n < problem.points.size(); ++n) {
        const std::uint32_t i = problem.points[n];
        for (const std::uint32_t j : {i + 1, i + static_cast<std::uint32_t>(nx) + 1}) {
            if (j < lattice.position.size() && (lattice.position[j] - lattice.position[i]).norm() < 2.1e-3) {
                problem.edges.push_back({i, j});
            }
        }
    }
    problem.tool = {{Vec3d(-0.05, 0.0, 0.0), Vec3d(0.05, 0.0, 0.0), 4e-3}};
    problem.tool_friction = friction;
    return problem;
}

/// Pose with the blade's underside that far below first contact with a block of `nz` cells.
Isometry3d pressed_in(int nz, double y, double depth) {
    return moved(Vec3d(0.0, y, nz * 2e-3 + 5e-3 - depth));
}

TEST(FrictionPath, DerivativesMatchFiniteDifferences) {
    // All terms of a round's energy: elements, a spring, balls and edges on a capsule, a solid, each pressed
    // and with friction. Central differences with a step of 1e-8 m: rounding 1e-16 / 1e-8 of an energy of
    // some millimetres times the force, truncation (1e-8 m / 1 mm)^2.
    PathProblem problem = block_under_blade(2, 2, 2, 0.3, true);
    const Plane wall(Vec3d::UnitY());
    problem.solid = &wall;
    problem.solid_friction = 0.2;
    for (std::uint32_t i = 0; i < problem.body.rest.size(); ++i) {
        if (problem.body.rest[i].y() < 1e-9) {
            problem.on_solid.push_back(i);
        }
    }
    problem.springs.push_back({13, 26, 2e-3, 30.0});
    problem.drag.assign(problem.body.rest.size(), 0.02);
    FrictionPath path(problem, {});
    ASSERT_TRUE(path.advance(pressed_in(2, 2e-3, 0.5e-3)).converged);
    ASSERT_TRUE(path.advance(pressed_in(2, 2.3e-3, 0.8e-3)).converged);
    EXPECT_GT(sum(path.tool_force()).norm(), 0.01);
    Random random(1);
    VectorXd x = path.position();
    for (Index i = 0; i < x.size(); ++i) {
        x[i] += 2e-5 * static_cast<double>(random.normal());
    }
    const VectorXd gradient = path.gradient(x);
    const Eigen::MatrixXd hessian = path.hessian(x, false);
    VectorXd gradient_difference(x.size());
    Eigen::MatrixXd hessian_difference(x.size(), x.size());
    for (Index i = 0; i < x.size(); ++i) {
        VectorXd up = x;
        VectorXd down = x;
        up[i] += 1e-8;
        down[i] -= 1e-8;
        gradient_difference[i] = (path.energy(up) - path.energy(down)) / 2e-8;
        hessian_difference.col(i) = (path.gradient(up) - path.gradient(down)) / 2e-8;
    }
    EXPECT_LT((gradient - gradient_difference).norm(), 1e-6 * gradient.norm());
    std::vector<Index> free;  // coordinates; held ones have no derivative
    for (Index i = 0; i < x.size(); ++i) {
        if (problem.body.rest[static_cast<std::size_t>(i / 3)].z() > 1e-9) {
            free.push_back(i);
        }
    }
    const Eigen::MatrixXd of_free = hessian(free, free);
    EXPECT_LT((of_free - hessian_difference(free, free)).norm(), 1e-5 * of_free.norm());
}

TEST(FrictionPath, FrictionlessPathMatchesStaticSolver) {
    // The static solver's obstacles are the same springs between vertex and capsule.
    PathProblem problem = block_under_blade(8, 6, 4, 0.0, false);
    problem.radius.assign(problem.radius.size(), 0.0);
    PathSettings settings;
    settings.multipliers = false;
    settings.residual = 1e-10;
    FrictionPath path(problem, settings);
    const Vec3d centre(0.0, 6e-3, 8e-3 + 4e-3 - 2e-3);
    ASSERT_TRUE(path.advance(moved(centre)).converged);
    Problem plain = problem.body;
    plain.obstacles = {
        {problem.tool[0].a + centre, problem.tool[0].b + centre, problem.tool[0].radius, settings.stiffness}};
    const Solution expected = solve(plain);
    ASSERT_TRUE(expected.converged);
    for (std::size_t i = 0; i < expected.position.size(); ++i) {
        EXPECT_LT((path.position().segment<3>(3 * static_cast<Index>(i)) - expected.position[i]).norm(),
                  1e-9);
    }
}

TEST(FrictionPath, BlockOnPlaneMatchesClosedForm) {
    // Squeezed from above on a frictionless plane, held at its top only along z, and at an edge: a
    // homogeneous state, which linear elements represent exactly. Penetration is below 0.02 mm of 8 mm.
    const TetrahedralLattice lattice = tetrahedral_lattice(4, 4, 4, 2e-3);
    PathProblem problem = path_problem(lattice, 0.3);
    const Plane floor;
    problem.solid = &floor;
    problem.on_solid = at_height(lattice, 0.0);
    std::vector<double> displacement;
    const double squeeze = -1e-3;
    for (std::uint32_t i = 0; i < lattice.position.size(); ++i) {
        const Vec3d& x = lattice.position[i];
        for (int axis = 0; axis < 3; ++axis) {
            if (axis < 2 ? x[axis] < 1e-9 : x.z() > 8e-3 - 1e-9) {
                problem.body.held.push_back({i, axis, 0.0});
                displacement.push_back(axis < 2 ? 0.0 : squeeze);
            }
        }
    }
    FrictionPath path(problem, {});
    const Increment done = path.advance(Isometry3d::Identity(), displacement);
    ASSERT_TRUE(done.converged);
    EXPECT_LT(done.penetration, 0.02e-3);
    const double area = 8e-3 * 8e-3;
    const double force = sum(path.solid_force()).z();
    const test::UniaxialStretch expected = test::uniaxial_stretch(-force / area, path_modulus, 0.3);
    EXPECT_NEAR(expected.along, 1.0 + squeeze / 8e-3, 0.02 / 8.0);
}

/// A block on an incline, with springs along it: the springs' force relative to the downhill pull.
double carried_by_spring(double slope, double friction) {
    const TetrahedralLattice lattice = tetrahedral_lattice(3, 2, 2, 2e-3);
    PathProblem problem = path_problem(lattice, 0.3);
    const Plane floor(Vec3d::UnitZ(), 1e-6);  // touches from the start: nothing else supports the block
    problem.solid = &floor;
    problem.on_solid = at_height(lattice, 0.0);
    problem.solid_friction = friction;
    for (std::uint32_t i = 0; i < lattice.position.size(); ++i) {
        if (lattice.position[i].y() < 1e-9) {
            problem.body.held.push_back({i, 1, 0.0});
        }
    }
    problem.body.density = 1000.0;
    problem.body.gravity = 9.81 * Vec3d(std::sin(slope), 0.0, -std::cos(slope));
    // Soft springs along x from each base vertex to its initial position: they leave it room to slide.
    constexpr double stiffness = 1e-2;
    for (const std::uint32_t i : problem.on_solid) {
        const auto anchor = static_cast<std::uint32_t>(problem.body.rest.size());
        problem.body.rest.push_back(lattice.position[i] - Vec3d(1.0, 0.0, 0.0));
        problem.body.hold(anchor);
        problem.springs.push_back({i, anchor, 1.0, stiffness});
    }
    PathSettings settings;
    settings.friction = 1e-4;
    FrictionPath path(problem, settings);
    EXPECT_TRUE(path.advance(Isometry3d::Identity()).converged);
    const Vec3d floors = sum(path.solid_force());
    const double volume = 6e-3 * 4e-3 * 4e-3;
    const double weight = volume * 1000.0 * 9.81;
    EXPECT_NEAR(floors.z(), weight * std::cos(slope), 1e-4 * weight);
    return 1.0 + floors.x() / (weight * std::sin(slope));
}

TEST(FrictionPath, BlockSlidesWhereTheSlopeExceedsTheFriction) {
    // The spring carries what friction does not: 1 - mu / tan(slope), and nothing while the block sticks.
    // Rounds end when friction changes by less than 1e-4 of the weight, at most 1e-3 of the downhill pull.
    // The omitted rounds would have added a few times that where convergence is slowest.
    constexpr double friction = 0.2;
    const double limit = std::atan(friction);
    EXPECT_NEAR(carried_by_spring(0.5 * limit, friction), 0.0, 5e-3);
    EXPECT_NEAR(carried_by_spring(0.95 * limit, friction), 0.0, 5e-3);
    for (const double slope : {1.05 * limit, 2.0 * limit}) {
        EXPECT_NEAR(carried_by_spring(slope, friction), 1.0 - friction / std::tan(slope), 1e-3);
    }
}

TEST(FrictionPath, FrictionDependsOnPath) {
    // A blade on the block is drawn across it and back: at the same position friction points in opposite
    // directions. Tetrahedra lack mirror symmetry, which takes part of it: half must remain.
    constexpr double friction = 0.1;
    PathProblem problem = block_under_blade(6, 8, 3, friction, true);
    FrictionPath path(problem, {});
    const auto along = [&](double y) {
        EXPECT_TRUE(path.advance(pressed_in(3, y, 1.5e-3)).converged) << y;
        return sum(path.tool_force());
    };
    Vec3d there = Vec3d::Zero();
    Vec3d back = Vec3d::Zero();
    for (const double y : {8e-3, 8.5e-3, 9e-3}) {
        there = along(y);
    }
    for (const double y : {9.5e-3, 10e-3, 9.5e-3, 9e-3}) {
        back = along(y);
    }
    EXPECT_GT(there.y(), 0.5 * friction * std::fabs(there.z()));
    EXPECT_LT(back.y(), -0.5 * friction * std::fabs(back.z()));
}

TEST(FrictionPath, EdgeContactsLeaveNoGap) {
    // A blade across the edges, between two rows of vertices. With balls only, it sinks in by the dip of the
    // circle of both radii over half a cell; with edge contacts, by at most that of their quarter points.
    const auto least = [](bool edges) {
        PathProblem problem = block_under_blade(6, 6, 3, 0.0, edges);
        problem.tool[0].radius = 1e-3;
        FrictionPath path(problem, {});
        EXPECT_TRUE(path.advance(moved(Vec3d(0.0, 5e-3, 6e-3 + 2e-3 - 0.6e-3))).converged);
        double deepest = 1.0;
        for (const auto& [i, j] : block_under_blade(6, 6, 3, 0.0, true).edges) {
            for (const double t : {0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0}) {
                const Vec3d p = (1.0 - t) * path.position().segment<3>(3 * static_cast<Index>(i)) +
                                t * path.position().segment<3>(3 * static_cast<Index>(j));
                deepest = std::min(deepest, std::hypot(p.y() - 5e-3, p.z() - 7.4e-3) - 2e-3);
            }
        }
        return deepest;
    };
    EXPECT_LT(least(false), -0.1e-3);
    EXPECT_GT(least(true), -0.05e-3);
}

TEST(FrictionPath, LineContactMatchesHertz) {
    // A cylinder on a slab in plane strain, without friction: the contact half-width a follows from the force
    // per length F' as a^2 = 4 F' R / (pi E*) (Hertz 1882). The pressure's second moment is a^2 / 4. With
    // vertices a cell apart, that moment is known to about a cell squared over six.
    constexpr int half = 12;
    constexpr double cell = 0.25e-3;
    const TetrahedralLattice lattice = tetrahedral_lattice(1, 4 * half, 3 * half, cell);
    PathProblem problem = path_problem(lattice, 0.3);
    const double top = 3 * half * cell;
    problem.points = at_height(lattice, top);
    for (std::uint32_t i = 0; i < lattice.position.size(); ++i) {
        problem.body.held.push_back({i, 0, 0.0});
        for (int axis = 1; axis < 3 && lattice.position[i].z() < 1e-9; ++axis) {
            problem.body.held.push_back({i, axis, 0.0});
        }
    }
    constexpr double radius = 10e-3;
    problem.tool = {{Vec3d(-0.05, 0.0, 0.0), Vec3d(0.05, 0.0, 0.0), radius}};
    PathSettings settings;
    settings.penetration = 1e-6;
    FrictionPath path(problem, settings);
    ASSERT_TRUE(path.advance(moved(Vec3d(0.0, 2 * half * cell, top + radius - 0.15e-3))).converged);
    double force = 0.0;
    double moment = 0.0;
    const std::vector<Vec3d> on = path.tool_force();
    for (std::size_t i = 0; i < on.size(); ++i) {
        force -= on[i].z();
        moment -= on[i].z() * std::pow(lattice.position[i].y() - 2 * half * cell, 2);
    }
    const double squared = 4.0 * (force / cell) * radius / (std::numbers::pi * path_modulus / (1.0 - 0.09));
    const double a = std::sqrt(squared);
    RecordProperty("half_width_mm", std::to_string(1e3 * a));
    EXPECT_GT(a, 4 * cell);
    EXPECT_NEAR(std::sqrt(4.0 * moment / force) / a, 1.0, 0.05);
}

TEST(FrictionPath, StepsMatchImplicitEuler) {
    // A tetrahedron on zero-length springs, one at each corner, that pull it as a whole: each step reduces
    // the distance by 1 / (1 + k dt / c). Newton's method leaves 1e-6 of an element's forces, a mN.
    constexpr double pull = 2.0;       // [N/m]
    constexpr double drag = 0.1;       // [N s/m]
    constexpr double duration = 0.02;  // [s]
    PathProblem problem;
    problem.body.youngs_modulus = path_modulus;
    problem.body.rest = {{0, 0, 0}, {2e-3, 0, 0}, {0, 2e-3, 0}, {0, 0, 2e-3}};
    problem.body.tetrahedra = {{0, 1, 2, 3}};
    const Vec3d away(3e-3, -2e-3, 1e-3);
    for (std::uint32_t i = 0; i < 4; ++i) {
        problem.body.rest.push_back(problem.body.rest[i] + away);
        problem.body.hold(i + 4);
        problem.springs.push_back({i, i + 4, 0.0, pull});
    }
    problem.drag.assign(8, drag);
    FrictionPath path(problem, {});
    double left = 1.0;
    for (int k = 0; k < 5; ++k) {
        ASSERT_TRUE(path.step(Isometry3d::Identity(), {}, duration, 1e-6).converged);
        left /= 1.0 + pull * duration / drag;
        for (std::uint32_t i = 0; i < 4; ++i) {
            const Vec3d expected = problem.body.rest[i] + (1.0 - left) * away;
            EXPECT_LT((path.position().segment<3>(3 * Index{i}) - expected).norm(), 1e-3 * away.norm());
        }
    }
}

TEST(FrictionPath, DragDoesNotAffectEquilibrium) {
    // A blade is pressed in and drawn across in steps, then held until nothing changes: the final state is an
    // equilibrium, and advance() confirms it. Without friction it does not depend on the path; advance()
    // leaves 0.02 mm of penetration, step() less, of 2 mm.
    const auto at_rest = [](double drag, double friction) {
        PathProblem problem = block_under_blade(6, 8, 3, friction, true);
        problem.drag.assign(problem.body.rest.size(), drag);
        FrictionPath path(problem, {});
        for (int k = 0; k <= 8; ++k) {
            const double share = static_cast<double>(k) / 8;
            EXPECT_TRUE(
                path.step(pressed_in(3, 6e-3 + 4e-3 * share, 2e-3 * share), {}, 0.02, 1e-6).converged);
        }
        for (double duration = 0.02; duration < 1e4; duration *= 2.0) {
            EXPECT_TRUE(path.step(pressed_in(3, 10e-3, 2e-3), {}, duration, 1e-6).converged);
        }
        const VectorXd there = path.position();
        EXPECT_TRUE(path.advance(pressed_in(3, 10e-3, 2e-3)).converged);
        EXPECT_LT((path.position() - there).cwiseAbs().maxCoeff(), 1e-6);
        return sum(path.tool_force());
    };
    const Vec3d usual = at_rest(0.01, 0.0);
    EXPECT_LT((at_rest(0.04, 0.0) - usual).norm(), 1e-3 * usual.norm());
    // Friction depends on the path, which drag changes: it may turn up to a tenth of the force, and turns
    // less.
    const Vec3d held_back = at_rest(0.01, 0.1);
    EXPECT_LT((at_rest(0.04, 0.1) - held_back).norm(), 0.1 * held_back.norm());
}

TEST(FrictionPath, StepsFollowSnapThrough) {
    // A shallow roof of two springs with a heavy hinge (a tetrahedron) that a blade pushes through: beyond
    // flat there is no equilibrium nearby, and once released it rests as far below as it stood above.
    constexpr double half = 10e-3;  // [m]
    constexpr double rise = 2e-3;   // [m]
    PathProblem problem;
    problem.body.youngs_modulus = path_modulus;
    problem.body.rest = {{-1e-3, -1e-3, rise}, {1e-3, -1e-3, rise}, {0, 1e-3, rise}, {0, 0, rise - 2e-3}};
    problem.body.tetrahedra = {{0, 1, 2, 3}};
    const double length = std::hypot(half, rise);
    // Each corner has one roof along x and one along y, so that it can only move up and down.
    for (std::uint32_t i = 0; i < 4; ++i) {
        for (const Vec3d& to :
             {Vec3d(half, 0, -rise), Vec3d(-half, 0, -rise), Vec3d(0, half, -rise), Vec3d(0, -half, -rise)}) {
            const auto anchor = static_cast<std::uint32_t>(problem.body.rest.size());
            problem.body.rest.push_back(problem.body.rest[i] + to);
            problem.body.hold(anchor);
            problem.springs.push_back({i, anchor, length, 100.0});
        }
    }
    problem.drag.assign(problem.body.rest.size(), 0.01);
    problem.radius.assign(problem.body.rest.size(), 0.0);
    problem.points = {0, 1, 2};
    problem.tool = {{Vec3d(-0.05, 0.0, 0.0), Vec3d(0.05, 0.0, 0.0), 4e-3}};
    FrictionPath path(problem, {});
    for (int k = 0; k <= 30; ++k) {
        ASSERT_TRUE(path.step(moved(Vec3d(0.0, 0.0, rise + 4e-3 - 0.1e-3 * k)), {}, 0.02, 1e-6).converged)
            << k;
    }
    for (double duration = 0.02; duration < 1e3; duration *= 2.0) {
        ASSERT_TRUE(path.step(moved(Vec3d(0.0, 0.0, 0.1)), {}, duration, 1e-6).converged);
    }
    for (std::uint32_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(path.position()[3 * Index{i} + 2] - problem.body.rest[i].z(), -2.0 * rise, 0.02e-3);
    }
}

TEST(FrictionPath, IsInsensitiveToSolverSettings) {
    // A blade pressed in and drawn across, as in the lift.
    const auto force = [](int increments, const PathSettings& settings) {
        FrictionPath path(block_under_blade(6, 8, 3, 0.1, true), settings);
        for (int k = 0; k <= increments; ++k) {
            const double share = static_cast<double>(k) / increments;
            EXPECT_TRUE(path.advance(pressed_in(3, 6e-3 + 4e-3 * share, 2e-3 * share)).converged);
        }
        return sum(path.tool_force());
    };
    const Vec3d usual = force(4, {});
    EXPECT_LT((force(8, {}) - usual).norm(), 0.01 * usual.norm());
    PathSettings stiffer;
    stiffer.stiffness *= 2.0;
    stiffer.sticking *= 2.0;
    EXPECT_LT((force(4, stiffer) - usual).norm(), 0.01 * usual.norm());
}

}  // namespace
}  // namespace eti::fem
