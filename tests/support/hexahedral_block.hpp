// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/pbd/implicit/implicit_mesh.hpp"

namespace eti::test {

inline constexpr double cell_modulus = 8e3;  ///< [Pa]
inline constexpr double cell_edge = 2e-3;    ///< [m]

/// A block of nx x ny x nz cells, held at z = 0 if wanted.
struct HexahedralBlock {
    pbd::Particles particles;
    pbd::ImplicitMesh mesh;

    HexahedralBlock(int nx, int ny, int nz, double nu, bool held) {
        const auto at = [&](int i, int j, int k) {
            return static_cast<std::uint32_t>((k * (ny + 1) + j) * (nx + 1) + i);
        };
        particles.resize(static_cast<std::size_t>(nx + 1) * (ny + 1) * (nz + 1));
        pbd::ImplicitMesh::Description description;
        std::vector<double> mass(particles.size(), 0.0);
        for (int k = 0; k <= nz; ++k) {
            for (int j = 0; j <= ny; ++j) {
                for (int i = 0; i <= nx; ++i) {
                    particles.rest[at(i, j, k)] = (cell_edge * Vec3d(i, j, k)).cast<float>();
                    if (i == nx || j == ny || k == nz) {
                        continue;
                    }
                    pbd::Hexahedra::Corners& cell = description.hexahedra.hexahedra.emplace_back();
                    for (int v = 0; v < 8; ++v) {
                        const std::uint32_t corner = at(i + (v & 1), j + (v >> 1 & 1), k + (v >> 2 & 1));
                        cell[static_cast<std::size_t>(v)] = corner;
                        mass[corner] += 1000.0 * cell_edge * cell_edge * cell_edge / 8.0;
                    }
                }
            }
        }
        particles.position = particles.predicted = particles.rest;
        for (std::size_t i = 0; i < particles.size(); ++i) {
            const bool fixed = held && particles.rest[i].z() < 1e-6f;
            particles.inverse_mass[i] = fixed ? 0.0f : static_cast<float>(1.0 / mass[i]);
        }
        description.hexahedra.youngs_modulus.assign(description.hexahedra.hexahedra.size(),
                                                    static_cast<float>(cell_modulus));
        description.hexahedra.poisson_ratio = static_cast<float>(nu);
        mesh.configure(description, particles, particles.inverse_mass);
    }

    void step(const Vec3f& gravity = Vec3f::Zero(), float dt = 1.0f / 180.0f) {
        for (std::size_t i = 0; i < particles.size(); ++i) {
            if (particles.inverse_mass[i] > 0.0f) {
                particles.velocity[i] += dt * gravity;
            }
            particles.predicted[i] = particles.position[i];
        }
        mesh.solve(particles, dt);
        for (std::size_t i = 0; i < particles.size(); ++i) {
            particles.velocity[i] = 0.9f / dt * (particles.predicted[i] - particles.position[i]);
            particles.position[i] = particles.predicted[i];
        }
    }
    [[nodiscard]] double farthest_from_rest() const {
        double most = 0.0;
        for (std::size_t i = 0; i < particles.size(); ++i) {
            most = std::max(most, double{(particles.position[i] - particles.rest[i]).norm()});
        }
        return most;
    }
};

}  // namespace eti::test
