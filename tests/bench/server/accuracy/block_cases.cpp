// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/accuracy/block_cases.hpp"

#include <cmath>
#include <numbers>

namespace eti::bench {

fem::Problem problem_on(const test::TetrahedralLattice& lattice) {
    fem::Problem problem;
    problem.rest = lattice.position;
    problem.tetrahedra = lattice.tetrahedra;
    problem.youngs_modulus = BodySettings{}.youngs_modulus;
    problem.poisson_ratio = poisson_ratio;
    return problem;
}

test::TetrahedralLattice reference_lattice(int x_mm, int y_mm, int z_mm, double cell) {
    const auto cells = [&](int mm) { return static_cast<int>(std::lround(mm * 1e-3 / cell)); };
    return test::tetrahedral_lattice(cells(x_mm), cells(y_mm), cells(z_mm), cell);
}

namespace {

constexpr double sample_cell = 5e-3;  // [m]; nodes common to all lattices
constexpr double settling = 2.5;      // [s]

bool is_sample(const Vec3d& p) {
    const Vec3d cells = p / sample_cell;
    return (cells - cells.array().round().matrix()).cwiseAbs().maxCoeff() < 1e-6;
}

/// A bar of 40 x 10 x 10 mm along x, compared by its displacements.
class Bar : public BlockCase {
  public:
    enum class Load { weight, traction, stretch, twist };

    Bar(Load load, double cell) : load_(load) {
        const test::TetrahedralLattice lattice = reference_lattice(40, 10, 10, cell);
        fem::Problem problem = problem_on(lattice);
        std::vector<Vec3d> start;
        for (std::size_t i = 0; i < lattice.position.size(); ++i) {
            const Vec3d& p = lattice.position[i];
            start.push_back(path(p, p.x() / length));
            if (p.x() < 1e-9 || (moves_end() && p.x() > length - 1e-9)) {
                problem.hold(static_cast<std::uint32_t>(i),
                             p.x() < 1e-9 ? Vec3d::Zero() : Vec3d(path(p, 1.0) - p));
            }
        }
        problem.gravity = load_ == Load::weight ? weight : Vec3d(Vec3d::Zero());
        if (load_ == Load::traction) {
            problem.force = test::end_traction(lattice, lattice.nx, {stress, 0, 0});
        }
        const fem::Solution solution = fem::solve(problem, moves_end() ? start : std::vector<Vec3d>{});
        if (!solution.converged) {
            throw std::runtime_error("the reference of '" + name() + "' did not converge");
        }
        for (std::size_t i = 0; i < lattice.position.size(); ++i) {
            if (is_sample(lattice.position[i])) {
                sample_.push_back(lattice.position[i]);
                expected_.push_back(solution.position[i]);
            }
        }
    }

    [[nodiscard]] std::string name() const override {
        switch (load_) {
            case Load::weight:
                return "cantilever";
            case Load::traction:
                return "traction";
            case Load::stretch:
                return "stretch";
            case Load::twist:
                break;
        }
        return "twist";
    }
    [[nodiscard]] bool fits(const BodySettings& /*setting*/) const override { return true; }

    [[nodiscard]] CaseResult run(const BodySettings& setting) const override {
        BlockBody body(40, 10, 10, setting);
        const test::TetrahedralLattice& lattice = body.lattice();
        for (std::size_t i = 0; i < lattice.position.size(); ++i) {
            const Vec3d p = lattice.position[i];
            if (p.x() < 1e-9) {
                body.hold(i);
            } else if (moves_end() && p.x() > length - 1e-9) {
                body.hold_along(i, [this, p](double share) { return path(p, share); });
            }
        }
        body.gravity = load_ == Load::weight ? weight : Vec3d(Vec3d::Zero());
        if (load_ == Load::traction) {
            body.force = test::end_traction(lattice, lattice.nx, {stress, 0, 0});
        }
        CaseResult outcome;
        outcome.frame_ms = body.settle(settling);
        outcome.particles = lattice.position.size();
        double squared = 0.0;
        double moved = 0.0;
        std::size_t next = 0;
        for (std::size_t i = 0; i < lattice.position.size(); ++i) {
            if (is_sample(lattice.position[i])) {
                // Both lattices traverse their nodes in the same order.
                squared += (body.particles().position[i].cast<double>() - expected_[next]).squaredNorm();
                moved += (expected_[next] - sample_[next]).squaredNorm();
                ++next;
            }
        }
        outcome.error = std::sqrt(squared / moved);
        return outcome;
    }

  private:
    static constexpr double length = 40e-3;                                // [m]
    static constexpr double stress = 0.1 * BodySettings{}.youngs_modulus;  // [Pa]
    inline static const Vec3d weight = Vec3d(0.0, 0.0, -0.981);  // [m/s^2]; a tenth: the tip sags by a tenth

    [[nodiscard]] bool moves_end() const { return load_ == Load::stretch || load_ == Load::twist; }
    /// Position of the moved end's points, at a share of the path.
    [[nodiscard]] Vec3d path(const Vec3d& p, double share) const {
        if (load_ == Load::stretch) {
            return p + Vec3d(share * 0.5 * length, 0, 0);
        }
        if (load_ == Load::twist) {
            const Vec3d axis(0, 5e-3, 5e-3);
            const Vec3d arm(0, p.y() - axis.y(), p.z() - axis.z());
            return Vec3d(p.x(), 0, 0) + axis +
                   Eigen::AngleAxisd(share * 0.5 * std::numbers::pi, Vec3d::UnitX()) * arm;
        }
        return p;
    }

    Load load_;
    std::vector<Vec3d> sample_, expected_;
};

}  // namespace

std::vector<std::unique_ptr<BlockCase>> block_cases(bool quick) {
    std::vector<std::unique_ptr<BlockCase>> cases;
    for (const Bar::Load load :
         {Bar::Load::weight, Bar::Load::traction, Bar::Load::stretch, Bar::Load::twist}) {
        cases.push_back(std::make_unique<Bar>(load, quick ? 2.0 * reference_cell : reference_cell));
    }
    add_indentations(cases, quick);
    return cases;
}

}  // namespace eti::bench
