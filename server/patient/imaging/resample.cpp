// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/resample.hpp"

#include <algorithm>
#include <cmath>

#include "server/parallel/loops.hpp"

namespace eti::imaging {

namespace {

constexpr float air = -1000.0f;

float interpolated(const Volume& volume, const Vec3d& at) {
    const Geometry& g = volume.geometry;
    std::array<int, 3> low{};
    std::array<float, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double p = at[static_cast<int>(k)];
        if (p < -0.5 || p > g.size[k] - 0.5) {
            return air;
        }
        const double inside = std::clamp(p, 0.0, static_cast<double>(g.size[k] - 1));
        low[k] = std::min(static_cast<int>(inside), g.size[k] - 2);
        t[k] = static_cast<float>(inside - low[k]);
    }
    float sum = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1;
        const int dy = corner >> 1 & 1;
        const int dz = corner >> 2;
        const float weight =
            (dx ? t[0] : 1.0f - t[0]) * (dy ? t[1] : 1.0f - t[1]) * (dz ? t[2] : 1.0f - t[2]);
        sum += weight * volume.at(low[0] + dx, low[1] + dy, low[2] + dz);
    }
    return sum;
}

}  // namespace

Volume upright(const Volume& volume, std::size_t most) {
    const Geometry& from = volume.geometry;
    Vec3d low = Vec3d::Constant(1e9);
    Vec3d high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p = from.point(corner & 1 ? from.size[0] - 1 : 0, corner >> 1 & 1 ? from.size[1] - 1 : 0,
                                   corner >> 2 ? from.size[2] - 1 : 0);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const Vec3d spacings = from.spacing();
    double spacing = spacings.minCoeff();
    const double room = (high - low).cwiseMax(Vec3d::Constant(spacing)).prod();
    spacing = std::max(spacing, std::cbrt(room / static_cast<double>(most)));

    Volume to;
    to.geometry.origin = low;
    to.geometry.step = spacing * Eigen::Matrix3d::Identity();
    for (int k = 0; k < 3; ++k) {
        to.geometry.size[static_cast<std::size_t>(k)] =
            static_cast<int>(std::floor((high[k] - low[k]) / spacing + 0.5)) + 1;
    }
    if (to.geometry.size == from.size && (to.geometry.step - from.step).norm() < 1e-3 * spacing &&
        (to.geometry.origin - from.origin).norm() < 1e-3 * spacing) {
        return {from, volume.value};
    }
    to.value.resize(to.geometry.count());
    // Voxels that fall on voxels (turned axes) keep their values to rounding.
    const Eigen::Matrix3d back = from.step.inverse();
    parallel::for_each(to.geometry.size[2], 1, [&](int z) {
        for (int y = 0; y < to.geometry.size[1]; ++y) {
            for (int x = 0; x < to.geometry.size[0]; ++x) {
                to.value[to.geometry.index(x, y, z)] =
                    interpolated(volume, back * (to.geometry.point(x, y, z) - from.origin));
            }
        }
    });
    return to;
}

Mask onto(const Geometry& geometry, const Mask& labels) {
    Mask result{geometry, std::vector<std::uint8_t>(geometry.count(), 0)};
    const Eigen::Matrix3d back = labels.geometry.step.inverse();
    parallel::for_each(geometry.size[2], 1, [&](int z) {
        for (int y = 0; y < geometry.size[1]; ++y) {
            for (int x = 0; x < geometry.size[0]; ++x) {
                const Vec3d at = back * (geometry.point(x, y, z) - labels.geometry.origin);
                const std::array<int, 3> i = {static_cast<int>(std::lround(at.x())),
                                              static_cast<int>(std::lround(at.y())),
                                              static_cast<int>(std::lround(at.z()))};
                if (labels.geometry.contains(i[0], i[1], i[2])) {
                    result.value[geometry.index(x, y, z)] = labels.at(i[0], i[1], i[2]);
                }
            }
        }
    });
    return result;
}

}  // namespace eti::imaging
