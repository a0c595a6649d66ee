// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "server/pbd/particles.hpp"
#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::test {

/// The method that position-based ones are measured against: a lattice of springs whose forces are
/// integrated explicitly (symplectic Euler, by the caller). Springs lie along the edges and along both
/// diagonals of the faces of every cell. What one cell adds to a spring of rest length L is
///     k = 0.1 E V / L^2 for an edge, 0.4 E V / L^2 for a diagonal
/// (V the cell's volume; inside, where cells share them, every spring has 0.4 E times the cell). That is the
/// only choice for which the springs store, in any uniform strain, what an isotropic solid does: comparing
/// the stiffness with an elastic reference is how Lloyd, Szekely & Harders 2007, "Identification of spring
/// parameters for deformable object simulation", find theirs. Central forces leave no choice of Poisson
/// ratio: it is 1/4 (Cauchy).
class MassSprings {
  public:
    static constexpr double poisson_ratio = 0.25;

    MassSprings() = default;
    MassSprings(const TetrahedralLattice& lattice, double youngs_modulus) {
        std::map<std::array<std::uint32_t, 2>, double> stiffness;
        const double volume = std::pow(lattice.cell, 3);
        const auto add = [&](std::uint32_t a, std::uint32_t b, double share) {
            const double squared = (lattice.position[a] - lattice.position[b]).squaredNorm();
            stiffness[{std::min(a, b), std::max(a, b)}] += share * youngs_modulus * volume / squared;
        };
        for (int z = 0; z < lattice.nz; ++z) {
            for (int y = 0; y < lattice.ny; ++y) {
                for (int x = 0; x < lattice.nx; ++x) {
                    const auto corner = [&](int k) {
                        return lattice.index(x + k % 2, y + k / 2 % 2, z + k / 4);
                    };
                    for (int a = 0; a < 8; ++a) {
                        for (int b = a + 1; b < 8; ++b) {
                            const int apart = (a ^ b) % 2 + (a ^ b) / 2 % 2 + (a ^ b) / 4;
                            if (apart < 3) {
                                add(corner(a), corner(b), apart == 1 ? 0.1 : 0.4);
                            }
                        }
                    }
                }
            }
        }
        for (const auto& [ends, k] : stiffness) {
            springs_.push_back(
                {ends[0], ends[1], static_cast<float>(k),
                 static_cast<float>((lattice.position[ends[0]] - lattice.position[ends[1]]).norm())});
        }
    }

    /// Adds the velocity change of the free particles due to the springs over `dt` [s].
    void accelerate(pbd::Particles& particles, float dt) const {
        for (const Spring& s : springs_) {
            const Vec3f apart = particles.position[s.b] - particles.position[s.a];
            const float length = apart.norm();
            if (length < 1e-9f) {
                continue;
            }
            const Vec3f impulse = (dt * s.stiffness * (length - s.length) / length) * apart;
            particles.velocity[s.a] += particles.inverse_mass[s.a] * impulse;
            particles.velocity[s.b] -= particles.inverse_mass[s.b] * impulse;
        }
    }

    [[nodiscard]] std::size_t size() const { return springs_.size(); }

  private:
    struct Spring {
        std::uint32_t a, b;
        float stiffness;  // [N/m]
        float length;     // [m]
    };
    std::vector<Spring> springs_;
};

}  // namespace eti::test
