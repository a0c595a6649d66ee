// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/signal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/math/random.hpp"

namespace eti::metrics {
namespace {

int count(std::span<const double> curve, double prominence) {
    PeakCounter counter(prominence);
    for (const double value : curve) {
        counter.add(value);
    }
    return counter.count();
}

// The definition itself: from each strict local maximum search for higher ground on either side; the higher
// of the two minima in between is its base.
int count_by_definition(const std::vector<double>& x, double prominence) {
    int found = 0;
    for (std::size_t i = 1; i + 1 < x.size(); ++i) {
        if (!(x[i] > x[i - 1] && x[i] > x[i + 1])) {
            continue;
        }
        double left = x[i];
        for (std::size_t j = i; j-- > 0 && x[j] <= x[i];) {
            left = std::min(left, x[j]);
        }
        double right = x[i];
        for (std::size_t j = i + 1; j < x.size() && x[j] <= x[i]; ++j) {
            right = std::min(right, x[j]);
        }
        found += x[i] - std::max(left, right) >= prominence ? 1 : 0;
    }
    return found;
}

TEST(PeakCounter, CountsPeriodsOfSine) {
    for (const int periods : {1, 4, 9}) {
        std::vector<double> curve;
        for (int i = 0; i <= 2000; ++i) {  // from trough to trough
            curve.push_back(-2.6 * std::cos(2 * std::numbers::pi * periods * i / 2000.0));
        }
        EXPECT_EQ(count(curve, 5.0), periods);  // prominence 5.2
        EXPECT_EQ(count(curve, 5.3), 0);
    }
}

TEST(PeakCounter, AgreesWithTheDefinitionOnRandomWalks) {
    Random random(11);
    int total = 0;
    for (int run = 0; run < 300; ++run) {
        std::vector<double> walk = {0.0};
        for (int i = 0; i < 400; ++i) {
            walk.push_back(walk.back() + static_cast<double>(random.normal()));
        }
        const int expected = count_by_definition(walk, 5.0);
        total += expected;
        EXPECT_EQ(count(walk, 5.0), expected);
    }
    EXPECT_GT(total, 1000);
}

TEST(PeakCounter, RampsAndBordersAreNoPeaks) {
    std::vector<double> ramp, fall;
    for (int i = 0; i < 100; ++i) {
        ramp.push_back(i);
        fall.push_back(-i);
    }
    EXPECT_EQ(count(ramp, 5.0), 0);
    EXPECT_EQ(count(fall, 5.0), 0);
}

// v = 30 A / T (s^2 - 2 s^3 + s^4): maximum speed 1.875 A / T, integral of the squared jerk 720 A^2 / T^5.
// Thus the dimensionless jerk is 720 / 1.875^2 = 204.8 for any size and duration (Flash & Hogan 1985).
TEST(LogDimensionlessJerk, MatchesMinimumJerkClosedForm) {
    for (const double duration : {1.0, 2.0, 5.0}) {
        for (const double way : {0.01, 0.1}) {
            std::vector<double> speed;
            const int samples = static_cast<int>(30.0 * duration);
            for (int i = 0; i < samples; ++i) {
                const double s = (i + 0.5) / samples;
                speed.push_back(30.0 * way / duration * s * s * (1.0 - s) * (1.0 - s));
            }
            // The jerk is largest at both ends, where a sample is lost.
            EXPECT_NEAR(log_dimensionless_jerk(speed, 30.0), -std::log(204.8), 12.0 / samples) << duration;
        }
    }
}

TEST(LogDimensionlessJerk, SubmovementsAndTremorLowerSmoothness) {
    std::vector<double> one, two, shaky;
    for (int i = 0; i <= 180; ++i) {
        const double t = i / 30.0;
        const auto bell = [&](double at) { return std::exp(-8 * (t - at) * (t - at)); };
        one.push_back(bell(3));
        two.push_back(bell(2) + bell(4));
        shaky.push_back(bell(3) + 0.3 * std::abs(std::sin(9 * t)) * bell(3));
    }
    EXPECT_LT(log_dimensionless_jerk(two, 30.0), log_dimensionless_jerk(one, 30.0) - 0.5);
    EXPECT_LT(log_dimensionless_jerk(shaky, 30.0), log_dimensionless_jerk(one, 30.0) - 0.5);
    EXPECT_TRUE(std::isnan(log_dimensionless_jerk(std::vector<double>(50, 0.0), 30.0)));
    EXPECT_TRUE(std::isnan(log_dimensionless_jerk(std::vector<double>{1.0}, 30.0)));
}

// Movements of 4 to 20 s, cut off anywhere: one sample more or less hardly matters.
TEST(LogDimensionlessJerk, IsInsensitiveToOneSample) {
    std::mt19937 random(7);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int movement = 0; movement < 200; ++movement) {
        const double duration = between(4.0, 20.0);
        std::vector<double> speed(static_cast<std::size_t>(30.0 * duration));
        for (int part = 0; part < static_cast<int>(duration); ++part) {
            const double at = between(0.0, duration), width = between(0.2, 0.9), height = between(0.2, 1.0);
            for (std::size_t i = 0; i < speed.size(); ++i) {
                const double x = (static_cast<double>(i) / 30.0 - at) / width;
                speed[i] += height * std::exp(-2.0 * x * x);
            }
        }
        const double whole = log_dimensionless_jerk(speed, 30.0);
        speed.pop_back();
        EXPECT_NEAR(log_dimensionless_jerk(speed, 30.0) / whole, 1.0, 0.02) << movement;
    }
}

TEST(BinnedSeries, AveragesOverBinsAndBridgesGaps) {
    BinnedSeries series(10.0, 100);
    for (int i = 0; i < 40; ++i) {  // two samples per bin
        series.add(0.05 * i, i);
    }
    ASSERT_EQ(series.values().size(), 19u);  // the last one is still being filled
    EXPECT_NEAR(series.values()[3], 6.5, 1e-12);
    series.add(2.45, 60.0);  // four bins without a sample
    ASSERT_EQ(series.values().size(), 24u);
    EXPECT_NEAR(series.values()[19], 38.5, 1e-12);
    EXPECT_NEAR(series.values()[21], 38.5 + 0.4 * (60.0 - 38.5), 1e-9);
}

TEST(BinnedSeries, StaysBoundedAndPreservesLine) {
    BinnedSeries series(30.0, 256);
    for (int i = 0; i < 180 * 600; ++i) {
        series.add(i / 180.0, i / 180.0);
    }
    EXPECT_LE(series.values().size(), 256u);
    EXPECT_GE(series.values().size(), 64u);
    for (std::size_t i = 0; i < series.values().size(); ++i) {
        // A bin's mean is the line at its middle; an odd merge weighs one bin less, half a bin at most.
        EXPECT_NEAR(series.values()[i], (static_cast<double>(i) + 0.5) * series.width(),
                    0.5 * series.width());
    }
}

TEST(Rocking, MeasuresDenoisingResidual) {
    Random random(2);
    std::vector<double> smooth, shaky;
    for (int i = 0; i < 600; ++i) {
        const double t = i / 30.0;
        smooth.push_back(30 * std::exp(-0.05 * (t - 10) * (t - 10)));
        shaky.push_back(smooth.back() + 0.5 * static_cast<double>(random.normal()));
    }
    EXPECT_LT(rocking(smooth), 0.05);
    // The noise is nearly all removed: the residual's maximum is close to the largest of 600 normal deviates,
    // 0.5 sqrt(2 ln 600) = 1.8, within the usual scatter of extremes of a fifth.
    EXPECT_NEAR(rocking(shaky), 0.5 * std::sqrt(2 * std::log(600.0)), 0.4);
}

}  // namespace
}  // namespace eti::metrics
