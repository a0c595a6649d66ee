// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <vector>

#include "server/pbd/soft/soft_body.hpp"

namespace eti::test {

inline constexpr float cluster_spacing = 2e-3f;        ///< [m]
inline constexpr float cluster_particle_mass = 8e-6f;  ///< [kg]

/// A block of `n` cubed particles, 2 mm apart, in clusters of 27 on every second lattice point, without
/// damping. All are free except the uppermost `held` layers.
inline pbd::SoftBody cluster_block(int n, float youngs_modulus, const Vec3f& at = Vec3f::Zero(),
                                   int held = 0) {
    constexpr float volume = cluster_spacing * cluster_spacing * cluster_spacing;
    pbd::SoftBody body;
    body.settings.damping = 0.0f;
    body.particles.resize(static_cast<std::size_t>(n * n * n));
    pbd::ShapeMatching::Description description;
    const auto index = [n](int x, int y, int z) { return static_cast<std::uint32_t>((z * n + y) * n + x); };
    for (int z = 0; z < n; ++z) {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                const std::uint32_t i = index(x, y, z);
                body.particles.rest[i] =
                    at + cluster_spacing *
                             Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                body.particles.inverse_mass[i] = z < n - held ? 1.0f / cluster_particle_mass : 0.0f;
            }
        }
    }
    description.first.push_back(0);
    for (int z = 1; z < n; z += 2) {
        for (int y = 1; y < n; y += 2) {
            for (int x = 1; x < n; x += 2) {
                for (int dz = -1; dz <= 1; ++dz) {
                    for (int dy = -1; dy <= 1; ++dy) {
                        for (int dx = -1; dx <= 1; ++dx) {
                            if (x + dx < n && y + dy < n && z + dz < n) {
                                description.member.push_back(index(x + dx, y + dy, z + dz));
                            }
                        }
                    }
                }
                description.first.push_back(static_cast<std::uint32_t>(description.member.size()));
                description.youngs_modulus.push_back(youngs_modulus);
            }
        }
    }
    description.particle_volume.assign(body.particles.size(), volume);
    description.fitting_mass.assign(body.particles.size(), cluster_particle_mass);
    body.shapes.configure(description, body.particles);
    body.reset();
    return body;
}

/// Unconstrained particles.
inline pbd::SoftBody loose_particles(std::size_t count) {
    pbd::SoftBody body;
    body.settings.damping = 0.0f;
    body.particles.resize(count);
    body.particles.inverse_mass.assign(count, 1.0f / cluster_particle_mass);
    pbd::ShapeMatching::Description description;
    description.first.push_back(0);
    body.shapes.configure(description, body.particles);
    return body;
}

inline void substep(pbd::SoftBody& body, float dt) {
    body.predict(dt, 1.0f);
    body.project(dt);
    body.finish(dt);
}

}  // namespace eti::test
