// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "tests/validation/fem/smooth_grid.hpp"

#include <algorithm>
#include <cmath>

namespace eti::fem {

namespace {

/// Weights of the four nodes around a point t in the middle one of three cells, and their derivatives.
struct Weights {
    std::array<std::array<double, 4>, 3> of;  // by order of the derivative
};

Weights weights_at(double t) {
    return {
        {{{0.5 * t * (-1.0 + t * (2.0 - t)), 1.0 + t * t * (-2.5 + 1.5 * t),
           0.5 * t * (1.0 + t * (4.0 - 3.0 * t)), 0.5 * t * t * (t - 1.0)},
          {-0.5 + t * (2.0 - 1.5 * t), t * (-5.0 + 4.5 * t), 0.5 + t * (4.0 - 4.5 * t), t * (-1.0 + 1.5 * t)},
          {2.0 - 3.0 * t, -5.0 + 9.0 * t, 4.0 - 9.0 * t, -1.0 + 3.0 * t}}}};
}

}  // namespace

Solid::Sample SmoothGrid::sample(const Vec3d& point) const {
    const double spacing = static_cast<double>(grid_.spacing);
    const Vec3d scaled = (point - grid_.origin.cast<double>()) / spacing;
    std::array<int, 3> base{};
    std::array<Weights, 3> weights;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        const double place = std::clamp(scaled[a], 0.0, static_cast<double>(grid_.size[axis] - 1));
        base[axis] = std::min(static_cast<int>(place), grid_.size[axis] - 2);
        weights[axis] = weights_at(place - base[axis]);
    }
    const auto inside = [&](std::size_t axis, int k) {
        return std::clamp(base[axis] + k - 1, 0, grid_.size[axis] - 1);
    };
    Sample out;
    out.slope.setZero();
    const auto& [wx, wy, wz] = weights;
    for (int z = 0; z < 4; ++z) {
        for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < 4; ++x) {
                const auto value =
                    static_cast<double>(grid_.value[grid_.index(inside(0, x), inside(1, y), inside(2, z))]);
                const auto product = [&, i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y),
                                      k = static_cast<std::size_t>(z)](std::size_t dx, std::size_t dy,
                                                                       std::size_t dz) {
                    return value * wx.of[dx][i] * wy.of[dy][j] * wz.of[dz][k];
                };
                out.distance += product(0, 0, 0);
                out.slope += Vec3d(product(1, 0, 0), product(0, 1, 0), product(0, 0, 1)) / spacing;
                Eigen::Matrix3d bend;
                bend << product(2, 0, 0), product(1, 1, 0), product(1, 0, 1), product(1, 1, 0),
                    product(0, 2, 0), product(0, 1, 1), product(1, 0, 1), product(0, 1, 1), product(0, 0, 2);
                out.bend += bend / (spacing * spacing);
            }
        }
    }
    return out;
}

}  // namespace eti::fem
