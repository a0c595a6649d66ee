// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>
#include <numbers>

namespace eti::test {

/// Force [N] on a rigid sphere pressed `depth` [m] into an elastic half-space without friction (Hertz 1882).
/// The contact's radius is sqrt(radius depth).
inline double hertz_force(double radius, double depth, double youngs_modulus, double poisson_ratio) {
    return 4.0 / 3.0 * youngs_modulus / (1.0 - poisson_ratio * poisson_ratio) * std::sqrt(radius) *
           std::pow(depth, 1.5);
}

/// Factor on Hertz's force for a layer of finite thickness bonded to a rigid floor: Dimitriadis, Horkay,
/// Maresca, Kachar & Chadwick 2002, Biophys J 82:2798, eq. 12, a series in contact radius over thickness.
/// Valid for depths up to a tenth of the thickness and of the radius.
inline double bonded_layer_factor(double contact_radius, double thickness, double poisson_ratio) {
    const double nu = poisson_ratio;
    constexpr double pi = std::numbers::pi;
    const double a = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1.0 - nu);
    const double b = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1.0 - nu);
    const double x = contact_radius / thickness;
    return 1.0 - 2.0 * a / pi * x + 4.0 * a * a / (pi * pi) * x * x -
           8.0 / std::pow(pi, 3) * (std::pow(a, 3) + 4.0 * pi * pi / 15.0 * b) * std::pow(x, 3) +
           16.0 * a / std::pow(pi, 4) * (std::pow(a, 3) + 3.0 * pi * pi / 5.0 * b) * std::pow(x, 4);
}

}  // namespace eti::test
