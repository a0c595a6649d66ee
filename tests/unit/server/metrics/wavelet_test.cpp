// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/wavelet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/math/random.hpp"

namespace eti::metrics {
namespace {

std::vector<double> noise(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> values(count);
    for (double& value : values) {
        value = static_cast<double>(random.normal());
    }
    return values;
}

double mean_square(std::span<const double> a, std::span<const double> b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sum / static_cast<double>(a.size());
}

TEST(Wavelet, ReconstructsEveryLengthExactly) {
    for (std::size_t length = 1; length <= 150; ++length) {
        const std::vector<double> signal = noise(length, length);
        const std::vector<double> back = inverse_transform(wavelet_transform(signal, 3));
        ASSERT_EQ(back.size(), length);
        for (std::size_t i = 0; i < length; ++i) {
            // The published coefficients are accurate to about 1e-12; three levels add a few of these.
            ASSERT_NEAR(back[i], signal[i], 1e-10) << "length " << length;
        }
    }
}

// Four vanishing moments: away from the borders the details of a cubic are zero, those of a quartic are not.
TEST(Wavelet, CubicHasNoDetails) {
    std::vector<double> cubic, quartic;
    for (int i = 0; i < 64; ++i) {
        const double x = (i - 32) / 32.0;
        cubic.push_back(1 + x * (2 - x * (3 - 4 * x)));
        quartic.push_back(x * x * x * x);
    }
    std::vector<double> low, high;
    split_level(cubic, low, high);
    for (std::size_t k = 4; k + 4 < high.size(); ++k) {
        EXPECT_NEAR(high[k], 0.0, 1e-11);
    }
    split_level(quartic, low, high);
    EXPECT_GT(std::abs(high[16]), 1e-7);
}

TEST(Wavelet, PreservesInteriorEnergy) {
    std::vector<double> signal(128, 0.0);
    const std::vector<double> middle = noise(64, 5);
    std::copy(middle.begin(), middle.end(), signal.begin() + 32);
    std::vector<double> low, high;
    split_level(signal, low, high);
    double before = 0.0;
    double after = 0.0;
    for (const double v : signal) {
        before += v * v;
    }
    for (std::size_t k = 0; k < low.size(); ++k) {
        after += low[k] * low[k] + high[k] * high[k];
    }
    EXPECT_NEAR(after, before, 1e-9 * before);
}

// Mean square error of soft thresholding one coefficient of true value m under unit normal noise at threshold
// l (Donoho & Johnstone 1994, appendix): a closed form.
double soft_threshold_risk(double l, double m) {
    const auto density = [](double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi); };
    const auto below = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
    return 1 + l * l + (m * m - l * l - 1) * (below(l - m) - below(-l - m)) - (l - m) * density(l + m) -
           (l + m) * density(l - m);
}

TEST(Wavelet, DenoisingErrorMatchesTheory) {
    constexpr std::size_t n = 1024;
    constexpr double sigma = 0.3;
    std::vector<double> clean(n);
    for (std::size_t i = 0; i < n; ++i) {  // "HeaviSine" of the same paper
        const double t = static_cast<double>(i) / n;
        clean[i] = 4 * std::sin(4 * std::numbers::pi * t) - std::copysign(1.0, t - 0.3) -
                   std::copysign(1.0, 0.72 - t);
    }
    const double threshold = std::sqrt(2 * std::log(static_cast<double>(n)));
    const WaveletTransform coefficients = wavelet_transform(clean, useful_levels(n));
    // The mirrored borders add some seven redundant coefficients to a level's n / 2^j independent ones; each
    // level therefore counts with its independent share.
    std::size_t independent = n;
    double expected = 0.0;
    for (const auto& level : coefficients.details) {
        independent /= 2;
        double sum = 0.0;
        for (const double d : level) {
            sum += sigma * sigma * soft_threshold_risk(threshold, d / sigma);
        }
        expected += sum / n * static_cast<double>(independent) / static_cast<double>(level.size());
    }
    expected += static_cast<double>(independent) * sigma * sigma / n;
    double mean = 0.0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        std::vector<double> noisy = noise(n, seed);
        for (std::size_t i = 0; i < n; ++i) {
            noisy[i] = clean[i] + sigma * noisy[i];
        }
        mean += mean_square(denoised(noisy), clean) / 40;
    }
    // Some 20 coefficients carry the error; the share of each level is an average over them, and the noise
    // level is estimated from the data: a scatter of about 1 / sqrt(20).
    EXPECT_NEAR(mean, expected, 0.2 * expected);
    EXPECT_LT(mean, 0.5 * sigma * sigma);
}

// The universal threshold exceeds the largest of n independent normal values with a probability that tends to
// one: of white noise hardly anything but the coarsest average remains.
TEST(Wavelet, DenoisingRemovesWhiteNoise) {
    constexpr std::size_t n = 1024;
    double left = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const std::vector<double> signal = noise(n, 100 + seed);
        const std::vector<double> zero(n, 0.0);
        left += mean_square(denoised(signal), zero) / 10;
    }
    // The approximation keeps its coefficients: (2^-7 n + 7 of the borders) / n of the variance of one,
    // doubled for their mirrored, correlated ends.
    EXPECT_LT(left, 2.0 * (n / 128.0 + 7.0) / n);
}

TEST(Wavelet, ShortOrConstantSignalsAreUnchanged) {
    EXPECT_TRUE(denoised({}).empty());
    const std::vector<double> few = {1, 5, 2};
    EXPECT_EQ(denoised(few), few);
    for (const double value : denoised(std::vector<double>(100, 7.0))) {
        EXPECT_NEAR(value, 7.0, 1e-10);
    }
}

}  // namespace
}  // namespace eti::metrics
