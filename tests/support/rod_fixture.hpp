// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "server/pbd/rod/rod.hpp"

namespace eti::test {

/// The default tube held by its connector: a cantilever of the full length, clamped at its end.
inline Tube cantilever() {
    Tube tube;
    tube.grip_from_tip = tube.length;
    tube.curve_radius = 0.0f;
    return tube;
}

/// Mass per length [kg/m] of a tube of the given density.
inline double line_density(const Tube& tube, const pbd::RodSettings& settings) {
    const double outer = 0.5 * double{tube.outer_diameter};
    const double inner = 0.5 * double{tube.inner_diameter};
    return double{settings.density} * 3.14159265358979323846 * (outer * outer - inner * inner);
}

/// Runs substeps with a force on the tip [N].
inline void run(pbd::Rod& rod, double seconds, float dt, const Vec3f& gravity, const RigidTransform& grip,
                const Vec3f& tip_force = Vec3f::Zero(), int passes = 1) {
    const int count = static_cast<int>(std::lround(seconds / double{dt}));
    for (int i = 0; i < count; ++i) {
        rod.predict(dt, gravity, grip);
        rod.load(rod.size() - 1, 1.0f, tip_force);
        for (int pass = 0; pass < passes; ++pass) {
            rod.solve();
        }
        rod.finish();
    }
}

/// Strongly damped, so that it settles within `settled` seconds: the slowest mode decays at a rate of at
/// least w^2 / c. Here w = 3.52 sqrt(E I / (m L^4)) >= 10 / s for the softest tube, and c = 20 / s.
inline pbd::RodSettings damped(int segments) {
    pbd::RodSettings settings;
    settings.segments = segments;
    settings.velocity_damping = 20.0f;
    return settings;
}
inline constexpr double settled = 3.0;  ///< [s]; e^-15 of the initial amplitude remains

}  // namespace eti::test
