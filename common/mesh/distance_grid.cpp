// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/mesh/distance_grid.hpp"

#include <algorithm>
#include <cmath>

namespace eti {
namespace {

/// The cell that contains a point, the point's local coordinates (0..1 along each axis) and the cell's eight
/// nodes.
struct GridCell {
    Vec3f place = Vec3f::Zero();
    std::array<float, 8> value{};  ///< x fastest
};

GridCell cell_at(const DistanceGrid& grid, const Vec3f& point) {
    const Vec3f scaled = (point - grid.origin) / grid.spacing;
    GridCell cell;
    std::array<int, 3> base{};
    std::array<std::size_t, 3> step{
        1, static_cast<std::size_t>(grid.size[0]),
        static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1])};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int last = grid.size[axis] - 1;
        const auto a = static_cast<Eigen::Index>(axis);
        // This comparison order maps NaN to zero, so no index leaves the grid.
        const float clamped = std::min(std::max(0.0f, scaled[a]), static_cast<float>(last));
        base[axis] = std::min(static_cast<int>(clamped), std::max(last - 1, 0));
        cell.place[a] = clamped - static_cast<float>(base[axis]);
        if (last == 0) {
            step[axis] = 0;
        }
    }
    const std::size_t corner = grid.index(base[0], base[1], base[2]);
    for (std::size_t k = 0; k < 8; ++k) {
        cell.value[k] = grid.value[corner + (k & 1) * step[0] + (k >> 1 & 1) * step[1] + (k >> 2) * step[2]];
    }
    return cell;
}

float mix(float a, float b, float t) {
    return a + (b - a) * t;
}

}  // namespace

std::array<int, 3> grid_nodes(const Vec3f& low, const Vec3f& high, float spacing) {
    std::array<int, 3> size{};
    for (int axis = 0; axis < 3; ++axis) {
        size[static_cast<std::size_t>(axis)] =
            static_cast<int>(std::ceil((high[axis] - low[axis]) / spacing)) + 1;
    }
    return size;
}

float DistanceGrid::distance(const Vec3f& point) const {
    const GridCell cell = cell_at(*this, point);
    const auto& v = cell.value;
    const Vec3f& t = cell.place;
    const float lower = mix(mix(v[0], v[1], t.x()), mix(v[2], v[3], t.x()), t.y());
    const float upper = mix(mix(v[4], v[5], t.x()), mix(v[6], v[7], t.x()), t.y());
    return mix(lower, upper, t.z());
}

DistanceSample DistanceGrid::sample(const Vec3f& point) const {
    const GridCell cell = cell_at(*this, point);
    const auto& v = cell.value;
    const Vec3f& t = cell.place;
    const std::array<float, 4> along_x = {mix(v[0], v[1], t.x()), mix(v[2], v[3], t.x()),
                                          mix(v[4], v[5], t.x()), mix(v[6], v[7], t.x())};
    const float lower = mix(along_x[0], along_x[1], t.y());
    const float upper = mix(along_x[2], along_x[3], t.y());
    const Vec3f gradient(
        mix(mix(v[1] - v[0], v[3] - v[2], t.y()), mix(v[5] - v[4], v[7] - v[6], t.y()), t.z()),
        mix(along_x[1] - along_x[0], along_x[3] - along_x[2], t.z()), upper - lower);
    DistanceSample result;
    result.distance = mix(lower, upper, t.z());
    const float length = gradient.norm();
    // On a ridge of the distance field the gradient vanishes; any direction is then equally good.
    if (length > 1e-6f * spacing) {
        result.normal = gradient / length;
    }
    return result;
}

SplineDistance DistanceGrid::spline_sample(const Vec3f& point) const {
    // B-spline weights of three nodes along each axis, then their first and second derivatives.
    std::array<std::array<float, 3>, 3> weight{};
    std::array<std::array<float, 3>, 3> slope{};
    std::array<std::array<std::size_t, 3>, 3> at{};
    const std::array<std::size_t, 3> step{
        1, static_cast<std::size_t>(size[0]),
        static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1])};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        const int last = size[axis] - 1;
        const float clamped =
            std::min(std::max(0.0f, (point[a] - origin[a]) / spacing), static_cast<float>(last));
        const int nearest = static_cast<int>(clamped + 0.5f);
        const float t = clamped - static_cast<float>(nearest);
        weight[axis] = {0.5f * (0.5f - t) * (0.5f - t), 0.75f - t * t, 0.5f * (0.5f + t) * (0.5f + t)};
        slope[axis] = {t - 0.5f, -2.0f * t, t + 0.5f};
        for (int k = 0; k < 3; ++k) {
            at[axis][static_cast<std::size_t>(k)] =
                step[axis] * static_cast<std::size_t>(std::clamp(nearest + k - 1, 0, last));
        }
    }
    constexpr std::array<float, 3> bend{1.0f, -2.0f, 1.0f};
    SplineDistance result;
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t j = 0; j < 3; ++j) {
            // Along x: value, first and second derivative of this row of nodes.
            float v = 0.0f;
            float s = 0.0f;
            float b = 0.0f;
            for (std::size_t i = 0; i < 3; ++i) {
                const float node = value[at[0][i] + at[1][j] + at[2][k]];
                v += weight[0][i] * node;
                s += slope[0][i] * node;
                b += bend[i] * node;
            }
            const float wy = weight[1][j];
            const float sy = slope[1][j];
            const float wz = weight[2][k];
            const float sz = slope[2][k];
            result.distance += wy * wz * v;
            result.gradient += Eigen::Vector3f(wy * wz * s, sy * wz * v, wy * sz * v);
            result.bend(0, 0) += wy * wz * b;
            result.bend(1, 1) += bend[j] * wz * v;
            result.bend(2, 2) += wy * bend[k] * v;
            result.bend(0, 1) += sy * wz * s;
            result.bend(0, 2) += wy * sz * s;
            result.bend(1, 2) += sy * sz * v;
        }
    }
    result.bend(1, 0) = result.bend(0, 1);
    result.bend(2, 0) = result.bend(0, 2);
    result.bend(2, 1) = result.bend(1, 2);
    result.gradient /= spacing;
    result.bend /= spacing * spacing;
    return result;
}

}  // namespace eti
