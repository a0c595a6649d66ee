// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cmath>

namespace eti::test {

struct UniaxialStretch {
    double along = 1.0;
    double across = 1.0;
};

/// Principal stretches of the energy mu/2 (tr(F^T F) - 3) + lambda/2 (J - gamma)^2 under the nominal stress
/// `p` [Pa] along one axis. With `ratio` = mu / lambda, the sides are free of stress for
///     J = 1 + ratio - ratio / l,  which leaves  p = mu (l - J / l^2),
/// an increasing function of the axial stretch l in the range searched.
inline UniaxialStretch uniaxial_stretch(double p, double youngs_modulus, double poisson_ratio) {
    const double mu = youngs_modulus / (2.0 * (1.0 + poisson_ratio));
    const double ratio = 1.0 - 2.0 * poisson_ratio;
    double low = 0.6;
    double high = 5.0;
    UniaxialStretch out;
    for (int n = 0; n < 60; ++n) {
        const double l = 0.5 * (low + high);
        const double volume = 1.0 + ratio - ratio / l;
        (mu * (l - volume / (l * l)) < p ? low : high) = l;
        out = {l, std::sqrt(volume / l)};
    }
    return out;
}

}  // namespace eti::test
