// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace eti::test {

/// An inextensible planar rod clamped at the origin along +z, bending in the z-y plane.
struct Elastica {
    double length = 0.0;              ///< [m]
    double stiffness = 0.0;           ///< E I [N m^2]
    double rest_curvature = 0.0;      ///< [1/m], positive towards +y
    Eigen::Vector2d tip_force{0, 0};  ///< [N], along z and y; direction is fixed in space
    Eigen::Vector2d weight{0, 0};     ///< [N/m], along z and y
};

struct ElasticaEnd {
    Eigen::Vector2d tip{0, 0};  ///< [m], z and y
    double clamp_moment = 0.0;  ///< [N m]
};

/// Solves E I (theta' - k0) = m, m' = -t x n with n(s) = F + w (L - s) and m(L) = 0 by shooting on
/// m(0): Runge-Kutta of fourth order in 2000 steps (error below 1e-12 L for turns of a few radians),
/// bisected after a scan for the sign change of m(L).
inline ElasticaEnd solve(const Elastica& rod) {
    struct State {
        double theta, moment, z, y;
    };
    const auto rate = [&](double s, const State& u) {
        const Eigen::Vector2d n = rod.tip_force + (rod.length - s) * rod.weight;
        return State{u.moment / rod.stiffness + rod.rest_curvature,
                     -(std::cos(u.theta) * n.y() - std::sin(u.theta) * n.x()), std::cos(u.theta),
                     std::sin(u.theta)};
    };
    const auto plus = [](const State& u, const State& r, double h) {
        return State{u.theta + h * r.theta, u.moment + h * r.moment, u.z + h * r.z, u.y + h * r.y};
    };
    const auto shoot = [&](double moment) {
        constexpr int steps = 2000;
        const double h = rod.length / steps;
        State u{0.0, moment, 0.0, 0.0};
        for (int i = 0; i < steps; ++i) {
            const double s = h * i;
            const State a = rate(s, u);
            const State b = rate(s + 0.5 * h, plus(u, a, 0.5 * h));
            const State c = rate(s + 0.5 * h, plus(u, b, 0.5 * h));
            const State d = rate(s + h, plus(u, c, h));
            u = plus(plus(plus(plus(u, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
        }
        return u;
    };
    // Upper bound of the moment at the clamp: all loads at the full lever arm.
    const double most = rod.length * (rod.tip_force.norm() + rod.length * rod.weight.norm()) + 1e-12;
    double low = -most;
    double high = most;
    double low_end = shoot(low).moment;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        const double end = shoot(middle).moment;
        if ((end < 0.0) == (low_end < 0.0)) {
            low = middle;
            low_end = end;
        } else {
            high = middle;
        }
    }
    const State end = shoot(0.5 * (low + high));
    return {{end.z, end.y}, 0.5 * (low + high)};
}

}  // namespace eti::test
