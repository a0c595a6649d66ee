// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/indentation.hpp"

#include <algorithm>
#include <cmath>

#include "server/pbd/contact/contact.hpp"
#include "tests/support/hertz.hpp"
#include "tests/validation/fem/static_solver.hpp"

namespace eti::bench {

namespace {

constexpr double pressing = 0.4;            // [s] until the depth is reached
constexpr double pressed = 1.0;             // [s]
constexpr double measuring = 0.2;           // [s] at the end of it, over which the force is averaged
constexpr double nowhere = 1.0;             // [m], a height above everything
constexpr double reference_cell = 1.25e-3;  // [m], of the finite elements

double top_of(const test::TetrahedralLattice& lattice) {
    return lattice.nz * lattice.cell;
}

bool is_on_top(const test::TetrahedralLattice& lattice, std::size_t i) {
    return lattice.position[i].z() > (lattice.nz - 0.5) * lattice.cell;
}

}  // namespace

double Indenter::height_over(const Vec3d& p, double depth, double top) const {
    const double dx = sphere ? p.x() - x : 0.0;
    const double squared = dx * dx + std::pow(p.y() - y, 2);
    return squared < radius * radius ? top - depth + radius - std::sqrt(radius * radius - squared) : nowhere;
}

HertzBlock::HertzBlock(double cell)
    : side_mm(static_cast<int>(std::lround(1e3 * cells * cell))),
      sphere{.sphere = true, .x = 0.0, .y = 0.0, .radius = cells * cell} {}

double HertzBlock::force(double depth, double youngs_modulus) const {
    // The block is as thick as the sphere's radius.
    return 0.25 * test::hertz_force(sphere.radius, depth, youngs_modulus, reference_ratio) *
           test::bonded_layer_factor(std::sqrt(sphere.radius * depth), sphere.radius, reference_ratio);
}

double press(BlockBody& body, const Indenter& indenter, double depth, bool mirrored) {
    const test::TetrahedralLattice& lattice = body.lattice();
    std::vector<std::size_t> top, left, front;
    for (std::size_t i = 0; i < lattice.position.size(); ++i) {
        const Vec3d& p = lattice.position[i];
        if (p.z() < 1e-9) {
            body.hold(i);
            continue;
        }
        if (is_on_top(lattice, i)) {
            top.push_back(i);
        }
        if (mirrored && p.x() < 1e-9) {
            left.push_back(i);
        }
        if (mirrored && p.y() < 1e-9) {
            front.push_back(i);
        }
    }
    const double half = indenter.sphere ? 0.0 : lattice.nx * lattice.cell;
    double elapsed = 0.0;
    double counted = 0.0;
    double sum = 0.0;
    body.contact = [&](pbd::Particles& p, double dt, double) {
        const double z = top_of(lattice) - std::min(1.0, elapsed / pressing) * depth + indenter.radius;
        const Vec3f a = Vec3d(indenter.x - half, indenter.y, z).cast<float>();
        const Vec3f b = Vec3d(indenter.x + half, indenter.y, z).cast<float>();
        const pbd::MovingCapsule capsule{a, b, a, b, static_cast<float>(indenter.radius)};
        double impulse = 0.0;
        for (const std::size_t i : top) {
            const Vec3f push = pbd::push_out_of(capsule, p.position[i], p.predicted[i], 0.0f, 0.0f);
            p.predicted[i] += push;
            impulse -= static_cast<double>(push.z()) * body.mass(i) / dt;
        }
        for (const std::size_t i : left) {
            p.predicted[i].x() = 0.0f;
        }
        for (const std::size_t i : front) {
            p.predicted[i].y() = 0.0f;
        }
        if (elapsed > pressed - measuring) {
            sum += impulse;
            counted += dt;
        }
        elapsed += dt;
    };
    (void)body.settle(pressed);
    return sum / counted;
}

double reference_force(Indenter indenter, double depth) {
    constexpr int cells = 8;
    const test::TetrahedralLattice lattice = test::tetrahedral_lattice(cells, cells, cells, reference_cell);
    indenter.x = indenter.y = 0.0;
    const std::size_t count = lattice.position.size();
    fem::Problem free;
    free.rest = lattice.position;
    free.tetrahedra = lattice.tetrahedra;
    free.youngs_modulus = BodySettings{}.youngs_modulus;
    free.poisson_ratio = reference_ratio;
    const fem::Potential potential(free);
    std::vector<bool> touching(count, false);
    std::vector<Vec3d> position = lattice.position;
    double force = 0.0;
    for (int round = 0; round < 20; ++round) {
        fem::Problem problem = free;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec3d& p = lattice.position[i];
            if (p.z() < 1e-9) {
                problem.hold(i);
                continue;
            }
            if (touching[i]) {
                problem.held.push_back(
                    {i, 2, indenter.height_over(position[i], depth, top_of(lattice)) - p.z()});
            }
            if (p.x() < 1e-9) {
                problem.held.push_back({i, 0, 0.0});
            }
            if (p.y() < 1e-9) {
                problem.held.push_back({i, 1, 0.0});
            }
        }
        if (round > 0) {
            position = fem::solve(problem, position).position;
        }
        Eigen::VectorXd x(3 * static_cast<Eigen::Index>(count));
        for (std::size_t i = 0; i < count; ++i) {
            x.segment<3>(3 * static_cast<Eigen::Index>(i)) = position[i];
        }
        const Eigen::VectorXd gradient = potential.gradient(x);
        bool changed = false;
        force = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
            if (!is_on_top(lattice, i)) {
                continue;
            }
            // Force that holds the node down against the body's elastic force.
            const double push = -gradient[3 * static_cast<Eigen::Index>(i) + 2];
            const bool inside =
                position[i].z() > indenter.height_over(position[i], depth, top_of(lattice)) + 1e-9;
            const bool now = touching[i] ? push > 0.0 : inside;
            changed = changed || now != touching[i];
            force += touching[i] ? push : 0.0;
            touching[i] = now;
        }
        if (round > 1 && !changed) {
            break;
        }
    }
    return 4.0 * force;
}

}  // namespace eti::bench
