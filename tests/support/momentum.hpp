// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/pbd/particles.hpp"

namespace eti::test {

/// [kg m/s], of the free particles; summed in double.
inline Vec3d linear_momentum(const pbd::Particles& p) {
    Vec3d sum = Vec3d::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p.inverse_mass[i] > 0.0f) {
            sum += p.velocity[i].cast<double>() / static_cast<double>(p.inverse_mass[i]);
        }
    }
    return sum;
}

inline Vec3d centre_of_mass(const pbd::Particles& p) {
    Vec3d sum = Vec3d::Zero();
    double mass = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p.inverse_mass[i] > 0.0f) {
            sum += p.position[i].cast<double>() / static_cast<double>(p.inverse_mass[i]);
            mass += 1.0 / static_cast<double>(p.inverse_mass[i]);
        }
    }
    return sum / mass;
}

/// [kg m^2/s], about the centre of mass.
inline Vec3d angular_momentum(const pbd::Particles& p) {
    const Vec3d centre = centre_of_mass(p);
    Vec3d sum = Vec3d::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (p.inverse_mass[i] > 0.0f) {
            const Vec3d arm = p.position[i].cast<double>() - centre;
            sum += arm.cross(p.velocity[i].cast<double>()) / static_cast<double>(p.inverse_mass[i]);
        }
    }
    return sum;
}

}  // namespace eti::test
