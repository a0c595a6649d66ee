// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <array>
#include <vector>

#include "server/pbd/fluid/fluid.hpp"

namespace eti::test {

/// Position of a water front at a time after the gate's removal.
struct MeasuredFront {
    float time;   ///< T = t sqrt(2 g / a)
    float front;  ///< Z = z / a
};

/// Martin & Moyce 1952, Phil. Trans. R. Soc. A 244:312, figure 3, column a wide and 2 a high, a = 2.25 in; a
/// published digitisation of the figure, accurate to a few per cent.
inline constexpr std::array<MeasuredFront, 11> martin_and_moyce = {{{0.832f, 1.217f},
                                                                    {1.219f, 1.474f},
                                                                    {1.997f, 2.292f},
                                                                    {2.547f, 2.995f},
                                                                    {3.345f, 4.134f},
                                                                    {4.034f, 4.944f},
                                                                    {4.418f, 5.881f},
                                                                    {5.091f, 6.980f},
                                                                    {5.685f, 7.945f},
                                                                    {6.306f, 8.966f},
                                                                    {6.822f, 9.986f}}};

/// An open vessel with its inner corner at the origin; distances inside are to the nearest of its five walls.
/// Nodes lie `spacing` [m] apart.
[[nodiscard]] DistanceGrid vessel(const Vec3f& inside, float spacing);

struct DamBreak {
    std::size_t particles = 0;
    std::size_t lost = 0;       ///< particles that left the domain
    std::vector<float> fronts;  ///< Z at the experiment's times
    double simulated = 0.0;     ///< [s], including the time in which the column settles behind its gate
    /// RMS of the relative deviations from the experiment.
    [[nodiscard]] float error() const;
};

/// The experiment with `columns` particles across the column's width, twice as many up, `deep` between the
/// trough's side walls; substep `dt` [s], `iterations` passes each.
[[nodiscard]] DamBreak dam_break(int columns, int deep, float dt, int iterations);

}  // namespace eti::test
