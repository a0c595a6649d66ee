// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "server/pbd/implicit/tetrahedra.hpp"
#include "tests/support/tetrahedral_lattice.hpp"

namespace eti::test {

/// A lattice of tetrahedra with the density of water, at rest.
struct TetrahedralBody {
    TetrahedralLattice lattice;
    pbd::Particles particles;
    pbd::Tetrahedra tetrahedra;

    TetrahedralBody(TetrahedralLattice shape, float youngs_modulus, float poisson_ratio)
        : lattice(std::move(shape)) {
        std::vector<double> mass(lattice.position.size(), 0.0);
        for (const auto& corner : lattice.tetrahedra) {
            for (const std::uint32_t i : corner) {
                mass[i] += 1000.0 / 4.0 * std::pow(lattice.cell, 3) / 6.0;
            }
        }
        particles.resize(mass.size());
        for (std::size_t i = 0; i < mass.size(); ++i) {
            particles.rest[i] = lattice.position[i].cast<float>();
            particles.inverse_mass[i] = static_cast<float>(1.0 / mass[i]);
        }
        particles.position = particles.predicted = particles.rest;
        const std::vector<float> modulus(lattice.tetrahedra.size(), youngs_modulus);
        tetrahedra.configure({lattice.tetrahedra, modulus, poisson_ratio}, particles);
    }
};

}  // namespace eti::test
