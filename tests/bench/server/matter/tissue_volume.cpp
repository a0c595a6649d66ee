// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/bench/server/matter/tissue_volume.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

namespace eti::bench {

namespace {

Eigen::Matrix3d edges_of(const std::array<std::uint32_t, 4>& corners, const std::vector<Vec3f>& at) {
    Eigen::Matrix3d edges;
    for (std::size_t k = 0; k < 3; ++k) {
        edges.col(static_cast<Eigen::Index>(k)) = (at[corners[k + 1]] - at[corners[0]]).cast<double>();
    }
    return edges;
}

}  // namespace

TissueVolume volume_of(std::span<const std::array<std::uint32_t, 4>> tetrahedra,
                       const std::vector<Vec3f>& rest, const std::vector<Vec3f>& position, double pitch) {
    TissueVolume out;
    std::map<std::array<int, 3>, int> covers;  // of grid points: tetrahedra that hold one
    double now = 0.0;
    double before = 0.0;
    for (const auto& corners : tetrahedra) {
        const double built = edges_of(corners, rest).determinant();
        const Eigen::Matrix3d edges = edges_of(corners, position);
        const double ratio = edges.determinant() / built;
        before += std::fabs(built) / 6.0;
        now += ratio * std::fabs(built) / 6.0;
        out.inverted += !(ratio > 0.0) ? 1 : 0;
        out.crushed += !(ratio > 0.5) ? 1 : 0;
        if (std::fabs(ratio) < 1e-6) {
            continue;
        }
        const Eigen::Matrix3d inverse = edges.inverse();
        const Vec3d origin = position[corners[0]].cast<double>();
        Eigen::AlignedBox3d box;
        for (const std::uint32_t i : corners) {
            box.extend(position[i].cast<double>());
        }
        const Eigen::Vector3i low = (box.min() / pitch).array().ceil().cast<int>();
        const Eigen::Vector3i high = (box.max() / pitch).array().floor().cast<int>();
        for (int x = low.x(); x <= high.x(); ++x) {
            for (int y = low.y(); y <= high.y(); ++y) {
                for (int z = low.z(); z <= high.z(); ++z) {
                    const Vec3d share = inverse * (pitch * Vec3d(x, y, z) - origin);
                    if (share.minCoeff() > 0.0 && share.sum() < 1.0) {
                        ++covers[{x, y, z}];
                    }
                }
            }
        }
    }
    out.share = now / before;
    const double cell = pitch * pitch * pitch;
    out.occupied = cell * static_cast<double>(covers.size());
    out.doubly_covered = cell * static_cast<double>(std::ranges::count_if(
                                    covers, [](const auto& point) { return point.second > 1; }));
    return out;
}

}  // namespace eti::bench
