// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/indentation.hpp"

#include <algorithm>
#include <cmath>

#include "server/pbd/contact/contact.hpp"
#include "tests/support/hertz.hpp"

namespace eti::bench {

namespace {

constexpr double stage = 1.0;      // [s] for each depth:
constexpr double pressing = 0.4;   // of it until the depth is reached,
constexpr double measuring = 0.2;  // and at the end of it, over which the force is averaged
constexpr double nowhere = 1.0;    // [m], a height above everything

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
    return 0.25 * test::hertz_force(sphere.radius, depth, youngs_modulus, poisson_ratio) *
           test::bonded_layer_factor(std::sqrt(sphere.radius * depth), sphere.radius, poisson_ratio);
}

std::vector<ForceSample> press(BlockBody& body, const Indenter& indenter, const std::vector<double>& depths,
                               bool mirrored, double& frame_ms) {
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
    std::vector<ForceSample> curve;
    for (const double depth : depths) {
        curve.push_back({depth, 0.0, 0.0});
    }
    const double half = indenter.sphere ? 0.0 : lattice.nx * lattice.cell;
    double elapsed = 0.0;
    std::vector<double> counted(depths.size(), 0.0);
    body.contact = [&](pbd::Particles& p, double dt, double) {
        const auto n = std::min(depths.size() - 1, static_cast<std::size_t>(elapsed / stage));
        const double within = elapsed / stage - static_cast<double>(n);
        const double from = n > 0 ? depths[n - 1] : 0.0;
        const double depth = from + std::min(1.0, within / pressing) * (depths[n] - from);
        const double z = top_of(lattice) - depth + indenter.radius;
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
        if (within > 1.0 - measuring) {
            curve[n].force += impulse;
            counted[n] += dt;
        }
        elapsed += dt;
    };
    frame_ms = body.settle(stage * static_cast<double>(depths.size()));
    for (std::size_t k = 0; k < curve.size(); ++k) {
        curve[k].force /= counted[k];
    }
    return curve;
}

std::vector<double> reference_forces(Indenter indenter, const std::vector<double>& depths) {
    const test::TetrahedralLattice lattice = reference_lattice(10, 10, 10);
    indenter.x = indenter.y = 0.0;
    const std::size_t count = lattice.position.size();
    const fem::Problem free = problem_on(lattice);
    const fem::Potential potential(free);
    std::vector<bool> touching(count, false);
    std::vector<Vec3d> position = lattice.position;
    std::vector<double> forces;
    for (const double depth : depths) {
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
        forces.push_back(4.0 * force);
    }
    return forces;
}

namespace {

/// Forces over the depths, compared by the RMS of their relative errors.
CaseResult compared(BlockBody& body, const Indenter& indenter, const std::vector<double>& depths,
                    bool mirrored, const std::vector<double>& expected) {
    CaseResult outcome;
    outcome.particles = body.lattice().position.size();
    outcome.curve = press(body, indenter, depths, mirrored, outcome.frame_ms);
    double squared = 0.0;
    for (std::size_t k = 0; k < depths.size(); ++k) {
        outcome.curve[k].expected = expected[k];
        squared += std::pow(outcome.curve[k].force / expected[k] - 1.0, 2);
    }
    outcome.error = std::sqrt(squared / static_cast<double>(depths.size()));
    return outcome;
}

/// The block that the sphere and the blade of 5 mm are pressed into, against finite elements.
class Indentation : public BlockCase {
  public:
    explicit Indentation(bool sphere)
        : indenter_{.sphere = sphere, .x = 10e-3, .y = 10e-3, .radius = blade_radius},
          depths_(indentation_depths()),
          expected_(reference_forces(indenter_, depths_)) {}

    [[nodiscard]] std::string name() const override { return indenter_.sphere ? "sphere" : "blade"; }
    [[nodiscard]] bool fits(const BodySettings& setting) const override { return setting.cell < 2.6e-3; }
    [[nodiscard]] CaseResult run(const BodySettings& setting) const override {
        BlockBody body(20, 20, 10, setting);
        return compared(body, indenter_, depths_, false, expected_);
    }

  private:
    Indenter indenter_;
    std::vector<double> depths_, expected_;
};

/// Pressed in so little that Hertz's solution holds, with a contact radius of four to five spacings.
class Hertz : public BlockCase {
  public:
    explicit Hertz(bool quick) : depths_(quick ? std::vector{1.0} : std::vector{1.0, 1.25, 1.5}) {}

    [[nodiscard]] std::string name() const override { return "hertz"; }
    [[nodiscard]] bool fits(const BodySettings& /*setting*/) const override { return true; }
    [[nodiscard]] CaseResult run(const BodySettings& setting) const override {
        const HertzBlock block(setting.cell);
        BlockBody body(block.side_mm, block.side_mm, block.side_mm, setting);
        std::vector<double> depths, expected;
        for (const double d : depths_) {
            depths.push_back(d * setting.cell);
            expected.push_back(block.force(depths.back(), setting.youngs_modulus));
        }
        return compared(body, block.sphere, depths, true, expected);
    }

  private:
    std::vector<double> depths_;  // in spacings
};

}  // namespace

void add_indentations(std::vector<std::unique_ptr<BlockCase>>& cases, bool quick) {
    if (!quick) {
        cases.push_back(std::make_unique<Indentation>(true));
        cases.push_back(std::make_unique<Indentation>(false));
    }
    cases.push_back(std::make_unique<Hertz>(quick));
}

}  // namespace eti::bench
