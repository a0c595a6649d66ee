// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/mucosa_pattern.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace eti::render {
namespace {

constexpr int side = 512;
using Plane = std::vector<std::complex<double>>;

const MucosaPattern& pattern() {
    static const MucosaPattern baked = mucosa_pattern(side);
    return baked;
}

/// In place, of a length that is a power of two, by Cooley and Tukey's recursion.
void transform(std::vector<std::complex<double>>& line) {
    const std::size_t n = line.size();
    if (n == 1) {
        return;
    }
    std::vector<std::complex<double>> even, odd;
    for (std::size_t i = 0; i < n; i += 2) {
        even.push_back(line[i]);
        odd.push_back(line[i + 1]);
    }
    transform(even);
    transform(odd);
    for (std::size_t k = 0; k < n / 2; ++k) {
        const auto turned =
            std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n)) *
            odd[k];
        line[k] = even[k] + turned;
        line[k + n / 2] = even[k] - turned;
    }
}

/// Power of one channel without its mean, [row][column] of the spectrum.
std::vector<double> power(std::size_t channel) {
    Plane plane;
    double mean = 0.0;
    for (const auto& texel : pattern().texels) {
        plane.emplace_back(texel[channel]);
        mean += texel[channel] / static_cast<double>(side * side);
    }
    for (int pass = 0; pass < 2; ++pass) {
        Plane turned(plane.size());
        for (int row = 0; row < side; ++row) {
            std::vector<std::complex<double>> line(plane.begin() + row * side,
                                                   plane.begin() + (row + 1) * side);
            transform(line);
            for (int k = 0; k < side; ++k) {
                turned[static_cast<std::size_t>(k * side + row)] = line[static_cast<std::size_t>(k)];
            }
        }
        plane = std::move(turned);
    }
    std::vector<double> spectrum;
    for (const auto& value : plane) {
        spectrum.push_back(std::norm(value));
    }
    spectrum[0] = 0.0;
    return spectrum;
}

double wavelength_mm(int row, int column) {
    const auto folded = [](int k) { return static_cast<double>(k < side / 2 ? k : side - k); };
    return 1e3 * static_cast<double>(MucosaPattern::period) / std::hypot(folded(row), folded(column));
}

/// Share of the power within wavelengths.
double share(const std::vector<double>& spectrum, double from_mm, double to_mm) {
    double within = 0.0, all = 0.0;
    for (int row = 0; row < side; ++row) {
        for (int column = 0; column < side; ++column) {
            const double here = spectrum[static_cast<std::size_t>(row * side + column)];
            const double length = wavelength_mm(row, column);
            all += here;
            within += length >= from_mm && length <= to_mm ? here : 0.0;
        }
    }
    return within / all;
}

TEST(MucosaPattern, ReliefLiesBetween50And500Micrometres) {
    for (const std::size_t channel : {1u, 2u}) {
        const std::vector<double> spectrum = power(channel);
        EXPECT_GT(share(spectrum, 0.05, 0.5), 0.6);
        EXPECT_LT(share(spectrum, 2.0, 100.0), 0.01);
    }
}

// A period would stand out of the spectrum as a peak.
TEST(MucosaPattern, NothingRepeatsAboveTwoMillimetres) {
    for (const std::size_t channel : {0u, 3u}) {
        const std::vector<double> spectrum = power(channel);
        double most = 0.0, sum = 0.0;
        for (int row = 0; row < side; ++row) {
            for (int column = 0; column < side; ++column) {
                const double here = spectrum[static_cast<std::size_t>(row * side + column)];
                sum += here;
                most = wavelength_mm(row, column) > 2.0 ? std::max(most, here) : most;
            }
        }
        EXPECT_LT(most / sum, 0.03);
    }
}

/// Whether a texel holds a vessel that a lens shows.
bool vessel(int x, int y) {
    return pattern().texels[static_cast<std::size_t>((y & (side - 1)) * side + (x & (side - 1)))][0] > 60;
}

TEST(MucosaPattern, VesselsCoverFewPercent) {
    int covered = 0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            covered += vessel(x, y) ? 1 : 0;
        }
    }
    EXPECT_GT(covered, side * side / 100);
    EXPECT_LT(covered, side * side / 8);
}

// A contour or a ridge of noise has no ends: it closes to a ring.
TEST(MucosaPattern, VesselsEnd) {
    int ends = 0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            if (!vessel(x, y)) {
                continue;
            }
            // At an end, a circle around it meets the vessel in one stretch; along a vessel in two.
            constexpr int directions = 48;
            constexpr double radius = 7.0;
            int stretches = 0;
            const auto on_circle = [&](int k) {
                const double angle = 2.0 * std::numbers::pi * k / directions;
                return vessel(static_cast<int>(std::lround(x + radius * std::cos(angle))),
                              static_cast<int>(std::lround(y + radius * std::sin(angle))));
            };
            for (int k = 0; k < directions; ++k) {
                stretches += on_circle(k) && !on_circle(k - 1) ? 1 : 0;
            }
            ends += stretches == 1 ? 1 : 0;
        }
    }
    EXPECT_GT(ends, 40) << "texels at ends";
}

TEST(MucosaPattern, IsFlatOnAverage) {
    for (const std::size_t channel : {1u, 2u}) {
        double sum = 0.0;
        for (const auto& texel : pattern().texels) {
            sum += texel[channel];
        }
        EXPECT_NEAR(sum / (side * side), 127.5, 0.5);
    }
}

}  // namespace
}  // namespace eti::render
