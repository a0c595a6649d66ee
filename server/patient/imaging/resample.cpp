// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/resample.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/parallel/loops.hpp"

namespace eti::imaging {

namespace {

constexpr float air = -1000.0f;

/// Whether the volume's voxels cover a position in voxel indices.
bool covers(const Geometry& g, const Vec3d& at) {
    return (at.array() >= -0.5).all() && at.x() <= g.size[0] - 0.5 && at.y() <= g.size[1] - 0.5 &&
           at.z() <= g.size[2] - 0.5;
}

/// Weights of four neighbours of a position `t` behind the second of them.
using Weights = std::array<float, 4>;

Weights linear_weights(float t) {
    return {0.0f, 1.0f - t, t, 0.0f};
}

/// Keys' cubic convolution (1981, IEEE Trans Acoust Speech Signal Process 29:1153), a = -1/2: it keeps edges
/// that linear interpolation blurs, and reproduces quadratic functions.
Weights cubic_weights(float t) {
    return {((-0.5f * t + 1.0f) * t - 0.5f) * t, (1.5f * t - 2.5f) * t * t + 1.0f,
            ((-1.5f * t + 2.0f) * t + 0.5f) * t, (0.5f * t - 0.5f) * t * t};
}

/// The value at a position in voxel indices, by weights along each axis; linear in the outermost cells.
template <Weights (*weights)(float)>
float interpolated(const Volume& volume, const Vec3d& at) {
    const Geometry& g = volume.geometry;
    if (!covers(g, at)) {
        return air;
    }
    std::array<Weights, 3> weight{};
    std::array<std::array<int, 4>, 3> index{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double inside = std::clamp(at[static_cast<int>(k)], 0.0, static_cast<double>(g.size[k] - 1));
        const int low = std::min(static_cast<int>(inside), g.size[k] - 2);
        const auto t = static_cast<float>(inside - low);
        const bool in_outer_cell = low == 0 || low + 2 == g.size[k];
        weight[k] = in_outer_cell ? linear_weights(t) : weights(t);
        for (int j = 0; j < 4; ++j) {
            index[k][static_cast<std::size_t>(j)] = std::clamp(low + j - 1, 0, g.size[k] - 1);
        }
    }
    float sum = 0.0f;
    for (std::size_t z = 0; z < 4; ++z) {
        for (std::size_t y = 0; y < 4; ++y) {
            const float row_weight = weight[1][y] * weight[2][z];
            if (row_weight == 0.0f) {
                continue;
            }
            const float* line = volume.value.data() + g.index(0, index[1][y], index[2][z]);
            float part = 0.0f;
            for (std::size_t x = 0; x < 4; ++x) {
                part += weight[0][x] * line[index[0][x]];
            }
            sum += row_weight * part;
        }
    }
    return sum;
}

/// Corners of the box along LPS around all voxels' centres.
std::array<Vec3d, 2> box_of(const Geometry& from) {
    Vec3d low = Vec3d::Constant(1e9);
    Vec3d high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p = from.point(corner & 1 ? from.size[0] - 1 : 0, corner >> 1 & 1 ? from.size[1] - 1 : 0,
                                   corner >> 2 ? from.size[2] - 1 : 0);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return {low, high};
}

/// An isotropic grid along LPS from `low` to `high`.
Geometry grid_over(const Vec3d& low, const Vec3d& high, double spacing) {
    Geometry grid;
    grid.origin = low;
    grid.step = spacing * Eigen::Matrix3d::Identity();
    for (int k = 0; k < 3; ++k) {
        grid.size[static_cast<std::size_t>(k)] =
            static_cast<int>(std::floor((high[k] - low[k]) / spacing + 0.5)) + 1;
    }
    return grid;
}

}  // namespace

Volume downsampled(const Volume& volume, double spacing) {
    const Geometry& from = volume.geometry;
    const auto [low, high] = box_of(from);
    Volume to{grid_over(low, high, spacing), {}};
    to.value.resize(to.geometry.count());
    const Eigen::Matrix3d back = from.step.inverse();
    // At most four samples per axis: 64 halve the noise three times.
    const int samples = std::clamp(static_cast<int>(std::lround(spacing / from.spacing().minCoeff())), 1, 4);
    parallel::for_each(to.geometry.size[2], 1, [&](int z) {
        for (int y = 0; y < to.geometry.size[1]; ++y) {
            for (int x = 0; x < to.geometry.size[0]; ++x) {
                float sum = 0.0f;
                int seen = 0;
                for (int s = 0; s < samples * samples * samples; ++s) {
                    const Vec3d part(s % samples, s / samples % samples, s / samples / samples);
                    const Vec3d off = (part.array() + 0.5) / samples - 0.5;
                    const Vec3d at =
                        back * (to.geometry.point(x + off.x(), y + off.y(), z + off.z()) - from.origin);
                    if (covers(from, at)) {
                        sum += interpolated<linear_weights>(volume, at);
                        ++seen;
                    }
                }
                to.value[to.geometry.index(x, y, z)] = 2 * seen < samples * samples * samples
                                                           ? std::numeric_limits<float>::quiet_NaN()
                                                           : sum / static_cast<float>(seen);
            }
        }
    });
    return to;
}

Geometry reoriented(const Geometry& geometry, const Eigen::Matrix3d& axes) {
    return {geometry.size, axes.transpose() * geometry.origin, axes.transpose() * geometry.step};
}

Geometry upright_grid(const Geometry& geometry) {
    const auto [low, high] = box_of(geometry);
    return grid_over(low, high, geometry.spacing().minCoeff());
}

std::vector<std::uint8_t> covered(const Geometry& grid, const Geometry& volume) {
    std::vector<std::uint8_t> result(grid.count());
    const Eigen::Matrix3d back = volume.step.inverse();
    parallel::for_each(grid.size[2], 1, [&](int z) {
        for (int y = 0; y < grid.size[1]; ++y) {
            for (int x = 0; x < grid.size[0]; ++x) {
                const Vec3d at = back * (grid.point(x, y, z) - volume.origin);
                result[grid.index(x, y, z)] = covers(volume, at) ? 1 : 0;
            }
        }
    });
    return result;
}

Volume resample_upright(const Volume& volume, const Geometry& from, std::size_t most) {
    const auto [low, high] = box_of(from);
    const Vec3d spacings = from.spacing();
    double spacing = spacings.minCoeff();
    const double room = (high - low).cwiseMax(Vec3d::Constant(spacing)).prod();
    spacing = std::max(spacing, std::cbrt(room / static_cast<double>(most)));

    Volume to{grid_over(low, high, spacing), {}};
    if (to.geometry.size == from.size && (to.geometry.step - from.step).norm() < 1e-3 * spacing &&
        (to.geometry.origin - from.origin).norm() < 1e-3 * spacing) {
        return {from, volume.value};
    }
    to.value.resize(to.geometry.count());
    // Voxels that coincide (permuted axes) keep their values up to rounding.
    const Eigen::Matrix3d back = from.step.inverse();
    parallel::for_each(to.geometry.size[2], 1, [&](int z) {
        for (int y = 0; y < to.geometry.size[1]; ++y) {
            for (int x = 0; x < to.geometry.size[0]; ++x) {
                to.value[to.geometry.index(x, y, z)] =
                    interpolated<cubic_weights>(volume, back * (to.geometry.point(x, y, z) - from.origin));
            }
        }
    });
    return to;
}

Mask resample_labels(const Geometry& geometry, const Mask& labels) {
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
