// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/pbd/soft/shape_matching.hpp"
#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::test {

inline constexpr double cube_radius = 1.8;      ///< [spacings], clusters of 3 x 3 x 3 particles
inline constexpr double patient_radius = 2.01;  ///< [spacings], as in the patient: 33 particles

/// Mass [kg] or volume [m^3] of the lattice's nodes: each tetrahedron gives a quarter to each corner.
inline std::vector<double> node_share(const TetrahedralLattice& lattice, double density) {
    std::vector<double> share(lattice.position.size(), 0.0);
    const double of_corner = density * lattice.cell * lattice.cell * lattice.cell / 24.0;
    for (const auto& corners : lattice.tetrahedra) {
        for (const std::uint32_t i : corners) {
            share[i] += of_corner;
        }
    }
    return share;
}

/// Clusters around every second node of a lattice, with particles of `mass` [kg] and `volume` [m^3] at its
/// nodes, and a modulus [Pa]. `radius` is in spacings.
inline pbd::ShapeMatching::Description lattice_clusters(const TetrahedralLattice& lattice,
                                                        const std::vector<double>& mass,
                                                        const std::vector<double>& volume,
                                                        double youngs_modulus, double radius = cube_radius) {
    const int reach = static_cast<int>(radius);
    const auto within = [](int from, int to, int most) { return from + to >= 0 && from + to <= most; };
    pbd::ShapeMatching::Description out;
    out.first.push_back(0);
    for (int z = 1; z < lattice.nz; z += 2) {
        for (int y = 1; y < lattice.ny; y += 2) {
            for (int x = 1; x < lattice.nx; x += 2) {
                for (int dz = -reach; dz <= reach; ++dz) {
                    for (int dy = -reach; dy <= reach; ++dy) {
                        for (int dx = -reach; dx <= reach; ++dx) {
                            if (dx * dx + dy * dy + dz * dz <= radius * radius && within(x, dx, lattice.nx) &&
                                within(y, dy, lattice.ny) && within(z, dz, lattice.nz)) {
                                out.member.push_back(lattice.index(x + dx, y + dy, z + dz));
                            }
                        }
                    }
                }
                out.first.push_back(static_cast<std::uint32_t>(out.member.size()));
                out.youngs_modulus.push_back(static_cast<float>(youngs_modulus));
            }
        }
    }
    for (std::size_t i = 0; i < mass.size(); ++i) {
        out.fitting_mass.push_back(static_cast<float>(mass[i]));
        out.particle_volume.push_back(static_cast<float>(volume[i]));
    }
    return out;
}

}  // namespace eti::test
