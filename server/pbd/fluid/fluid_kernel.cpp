// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/pbd/fluid/fluid_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace eti::pbd {

namespace {

constexpr double pi = std::numbers::pi;

/// Simpson's rule; the integrands are polynomials, for which 200 intervals are exact to single precision.
template <class Integrand>
double integral(double from, double to, const Integrand& integrand) {
    constexpr int steps = 200;
    const double width = (to - from) / steps;
    double sum = integrand(from) + integrand(to);
    for (int k = 1; k < steps; ++k) {
        sum += (k % 2 == 1 ? 4.0 : 2.0) * integrand(from + k * width);
    }
    return sum * width / 3.0;
}

}  // namespace

FluidKernel::FluidKernel(float support_radius)
    : radius(support_radius),
      inverse_radius(1.0f / support_radius),
      peak(static_cast<float>(21.0 / (2.0 * pi * std::pow(support_radius, 3)))),
      slope(static_cast<float>(210.0 / (pi * std::pow(support_radius, 5)))) {}

float FluidKernel::value(float r) const {
    const float q = std::min(r * inverse_radius, 1.0f);
    const float t = 1.0f - q;
    return peak * t * t * t * t * (4.0f * q + 1.0f);
}

float FluidKernel::gradient_over_distance(float r) const {
    const float t = 1.0f - std::min(r * inverse_radius, 1.0f);
    return -slope * t * t * t;
}

float FluidKernel::lattice_volume(float spacing) const {
    const int reach = static_cast<int>(radius / spacing);
    double sum = 0.0;
    for (int x = -reach; x <= reach; ++x) {
        for (int y = -reach; y <= reach; ++y) {
            for (int z = -reach; z <= reach; ++z) {
                sum += value(spacing * std::sqrt(static_cast<float>(x * x + y * y + z * z)));
            }
        }
    }
    return static_cast<float>(1.0 / sum);
}

float cohesion_strength(float tension, float particle_volume, float kernel_radius) {
    // Integral of q^4 cohesion_shape(q) over q from 0 to 1.
    constexpr double moment = 2.0 / 35.0;
    return static_cast<float>(8.0 * tension * particle_volume * particle_volume /
                              (pi * moment * std::pow(kernel_radius, 5)));
}

WallTable::WallTable(const FluidKernel& kernel) : scale_(static_cast<float>(intervals) / kernel.radius) {
    const double h = kernel.radius;
    for (std::size_t k = 0; k < intervals; ++k) {
        const double d = h * static_cast<double>(k) / static_cast<double>(intervals);
        const auto value = [&](double r) { return static_cast<double>(kernel.value(static_cast<float>(r))); };
        // A sphere of radius r about the particle has area 2 pi r (r - d) behind the wall. With m the
        // direction's component normal to the wall, it is 2 pi r^2 dm for m from d / r to 1.
        entry_[k].density =
            static_cast<float>(integral(d, h, [&](double r) { return value(r) * 2.0 * pi * r * (r - d); }));
        entry_[k].gradient =
            static_cast<float>(-integral(d, h, [&](double r) { return value(r) * 2.0 * pi * r; }));
        entry_[k].adhesion = static_cast<float>(
            integral(d, h, [&](double r) { return cohesion_shape(r / h) * pi * (r * r - d * d); }));
        entry_[k].drag = static_cast<float>(integral(d, h, [&](double r) {
            const double m = r > 0.0 ? d / r : 0.0;
            const double steep = -kernel.gradient_over_distance(static_cast<float>(r));
            return steep * pi * r * r * (2.0 / 3.0 - m + m * m * m / 3.0);
        }));
    }
}

WallTerms WallTable::at(float distance) const {
    const float place = std::max(distance, 0.0f) * scale_;
    if (!(place < static_cast<float>(intervals))) {
        return {};
    }
    const auto k = static_cast<std::size_t>(place);
    const float t = place - static_cast<float>(k);
    const WallTerms& a = entry_[k];
    const WallTerms& b = entry_[k + 1];
    return {a.density + t * (b.density - a.density), a.gradient + t * (b.gradient - a.gradient),
            a.adhesion + t * (b.adhesion - a.adhesion), a.drag + t * (b.drag - a.drag)};
}

}  // namespace eti::pbd
