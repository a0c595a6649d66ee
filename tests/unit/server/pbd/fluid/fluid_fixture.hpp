// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "server/pbd/fluid/fluid.hpp"

namespace eti::pbd::fluid_fixture {

inline constexpr float spacing = 1e-3f;
inline constexpr float dt = 1.0f / 1440.0f;
inline constexpr float g = 9.81f;

inline Vec3f at(int x, int y, int z) {
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

/// A vessel: empty inside the box from `lower` to `upper` of the frame `pose`, solid beyond it.
inline DistanceGrid vessel(const Vec3f& lower, const Vec3f& upper,
                           const RigidTransform& pose = RigidTransform{}) {
    constexpr float margin = 4e-3f;
    DistanceGrid grid;
    grid.spacing = 0.5e-3f;
    Vec3f low = Vec3f::Constant(1e3f), high = Vec3f::Constant(-1e3f);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3f point = pose * Vec3f((corner & 1 ? upper : lower).x(), (corner & 2 ? upper : lower).y(),
                                         (corner & 4 ? upper : lower).z());
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    grid.origin = low - Vec3f::Constant(margin);
    const Vec3f extent = high - low + Vec3f::Constant(2.0f * margin);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        grid.size[axis] = static_cast<int>(extent[static_cast<Eigen::Index>(axis)] / grid.spacing) + 2;
    }
    const RigidTransform back = pose.inverse();
    for (int z = 0; z < grid.size[2]; ++z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                const Vec3f local = back * grid.node(x, y, z);
                const Vec3f inside = (local - lower).cwiseMin(upper - local);
                const float beyond = inside.cwiseMin(0.0f).norm();
                grid.value.push_back(beyond > 0.0f ? -beyond : inside.minCoeff());
            }
        }
    }
    return grid;
}

/// Water without surface tension and with free slip along walls.
inline FluidSettings plain() {
    FluidSettings settings;
    settings.surface_tension = 0.0f;
    settings.wall_viscosity = 0.0f;
    return settings;
}

/// Adds a block of particles on a lattice, its lower corner at the origin of `pose`.
inline void fill(Fluid& fluid, int nx, int ny, int nz, const RigidTransform& pose = RigidTransform{}) {
    for (int z = 0; z < nz; ++z) {
        for (int y = 0; y < ny; ++y) {
            for (int x = 0; x < nx; ++x) {
                fluid.add(pose * (spacing * (at(x, y, z) + Vec3f::Constant(0.5f))));
            }
        }
    }
}

/// Adds a ball of particles on a lattice about the origin.
inline void fill_ball(Fluid& fluid, float radius) {
    const int n = static_cast<int>(radius / spacing) + 1;
    for (int z = -n; z <= n; ++z) {
        for (int y = -n; y <= n; ++y) {
            for (int x = -n; x <= n; ++x) {
                if (spacing * at(x, y, z).norm() < radius) {
                    fluid.add(spacing * at(x, y, z));
                }
            }
        }
    }
}

inline Vec3d mean_velocity(const Fluid& fluid) {
    Vec3d sum = Vec3d::Zero();
    for (const Vec3f& v : fluid.velocities()) {
        sum += v.cast<double>();
    }
    return sum / static_cast<double>(fluid.count());
}

/// Root mean square of the particles' speeds [m/s].
inline double agitation(const Fluid& fluid) {
    double sum = 0.0;
    for (const Vec3f& v : fluid.velocities()) {
        sum += static_cast<double>(v.squaredNorm());
    }
    return std::sqrt(sum / static_cast<double>(fluid.count()));
}

inline Vec3f centre(const Fluid& fluid) {
    Vec3d sum = Vec3d::Zero();
    for (const Vec3f& x : fluid.positions()) {
        sum += x.cast<double>();
    }
    return (sum / static_cast<double>(fluid.count())).cast<float>();
}

/// Positions in the order in which the particles were added.
inline std::vector<Vec3f> by_id(const Fluid& fluid) {
    std::vector<std::pair<std::uint32_t, Vec3f>> pairs;
    for (std::size_t i = 0; i < fluid.count(); ++i) {
        pairs.emplace_back(fluid.ids()[i], fluid.positions()[i]);
    }
    std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Vec3f> positions;
    for (const auto& pair : pairs) {
        positions.push_back(pair.second);
    }
    return positions;
}

}  // namespace eti::pbd::fluid_fixture
