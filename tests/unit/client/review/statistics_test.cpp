// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "common/math/random.hpp"

namespace eti::review {
namespace {

// Two samples, and the results of algorithm 16.2 of Efron & Tibshirani and of its dual interval in
// NumPy 1.24, with a million resamples.
const std::vector<double> first{3.1, 4.4, 2.2, 5.0, 3.7, 4.9, 2.8}, second{5.2, 6.9, 4.1, 9.3, 5.5};
const std::vector<double> within{0.6, 1.2, -0.3, 2.2, 0.9, 1.4};
constexpr Bootstrap many{200'000, 3, 0.95};
/// Four standard errors of a share of 0.07 among 200,000, and of the reference.
constexpr double chance_of_p = 4.0 * 0.0007;
/// Four standard errors of an end, of both: 0.0087 for two samples and 0.0023 for pairs, from the density of
/// |t| at its quantile of 0.95 among a million draws.
constexpr double end_error = 4.0 * 1.1 * 0.0087, end_error_within = 4.0 * 1.1 * 0.0023;

TEST(Statistics, TwoSampleComparisonMatchesSciPy) {
    const Difference found = difference_between(first, second, many);
    EXPECT_NEAR(found.value, 2.4714285714, 1e-9);
    EXPECT_NEAR(found.interval.low, -0.2390, end_error);
    EXPECT_NEAR(found.interval.high, 5.1818, end_error);
    EXPECT_NEAR(found.p, 0.065409, chance_of_p);
    // Closed form, and the roots of scipy.stats.nct.
    EXPECT_NEAR(found.effect, 1.5025975458, 1e-8);
    EXPECT_NEAR(found.effect_interval.low, 0.2334017213, 1e-5);
    EXPECT_NEAR(found.effect_interval.high, 2.7181957472, 1e-5);
}

TEST(Statistics, PairedComparisonMatchesSciPy) {
    const Difference found = difference_within(within, many);
    EXPECT_NEAR(found.value, 1.0, 1e-12);
    EXPECT_NEAR(found.interval.low, 0.1439, end_error_within);
    EXPECT_NEAR(found.interval.high, 1.8561, end_error_within);
    EXPECT_NEAR(found.p, 0.028483, chance_of_p);
    EXPECT_NEAR(found.effect, 1.0048868785, 1e-8);
    EXPECT_NEAR(found.effect_interval.low, 0.0750300743, 1e-5);
    EXPECT_NEAR(found.effect_interval.high, 1.8843865345, 1e-5);
}

TEST(Statistics, PValueMatchesExhaustiveBootstrap) {
    // Four values have 4^4 draws: all of them are used.
    const std::vector<double> values{1.0, 2.0, 4.0, 6.0};
    const double mean = mean_of(values);
    const double t = std::abs(mean / (standard_deviation(values) / 2.0));
    int as_far = 0;
    for (int draw = 0; draw < 256; ++draw) {
        std::vector<double> drawn;
        for (int i = 0, rest = draw; i < 4; ++i, rest /= 4) {
            drawn.push_back(values[static_cast<std::size_t>(rest % 4)] - mean);
        }
        const double deviation = standard_deviation(drawn);
        const double there = deviation > 1e-9 ? std::abs(mean_of(drawn) / (deviation / 2.0))
                                              : std::numeric_limits<double>::infinity();
        as_far += there >= t ? 1 : 0;
    }
    const double exact = as_far / 256.0;
    ASSERT_GT(exact, 0.01);
    ASSERT_LT(exact, 0.2);
    EXPECT_NEAR(difference_within(values, many).p, exact,
                4.0 * std::sqrt(exact * (1.0 - exact) / many.resamples) + 1.0 / many.resamples);
}

std::vector<double> normal_sample(std::size_t size, Random& random) {
    std::vector<double> values;
    while (values.size() < size) {
        values.push_back(static_cast<double>(random.normal()));
    }
    return values;
}

TEST(Statistics, FalsePositivesStayNearNominalLevel) {
    Random random(11);
    constexpr int rounds = 2000;
    // Three standard errors above the nominal rate. The test errs on the safe side, but not by rejecting
    // nothing.
    const double most = 0.05 + 3.0 * std::sqrt(0.05 * 0.95 / rounds), least = 0.01;
    for (std::size_t n = 5; n <= 8; ++n) {
        int between = 0, within = 0;
        for (int round = 0; round < rounds; ++round) {
            const Bootstrap how{499, static_cast<std::uint64_t>(round), 0.95};
            const auto a = normal_sample(n, random), b = normal_sample(n, random);
            std::vector<double> change(b);
            for (std::size_t i = 0; i < n; ++i) {
                change[i] -= a[i];
            }
            const auto excludes_zero = [](const Difference& found) {
                EXPECT_EQ(found.interval.low > 0.0 || found.interval.high < 0.0, found.p <= 0.05);
                return found.interval.low > 0.0 || found.interval.high < 0.0 ? 1 : 0;
            };
            between += excludes_zero(difference_between(a, b, how));
            within += excludes_zero(difference_within(change, how));
        }
        for (const auto& [name, found] : {std::pair("between", between), {"within", within}}) {
            const double rate = static_cast<double>(found) / rounds;
            std::printf("n = %zu, %s: rejected %.1f %% of samples without a difference\n", n, name,
                        100.0 * rate);
            EXPECT_LT(rate, most) << name << " n = " << n;
            EXPECT_GT(rate, least) << name << " n = " << n;
        }
    }
}

TEST(Statistics, TinySampleHasNoInterval) {
    // Of three values, a ninth of all draws repeat one of them: no finite interval reaches 95 %.
    const Difference found = difference_within(std::vector<double>{1.0, 1.1, 1.2}, many);
    EXPECT_GT(found.p, 0.05);
    EXPECT_TRUE(std::isnan(found.interval.low));
}

TEST(Statistics, SwappingSamplesNegatesDifference) {
    const Difference there = difference_between(first, second, many),
                     back = difference_between(second, first, many);
    EXPECT_NEAR(there.value, -back.value, 1e-12);
    EXPECT_NEAR(there.interval.low, -back.interval.high, 2.0 * end_error);
    EXPECT_NEAR(there.effect, -back.effect, 1e-12);
    EXPECT_NEAR(there.effect_interval.low, -back.effect_interval.high, 1e-6);
}

TEST(Statistics, ResultDependsOnlyOnSeed) {
    const Bootstrap some{1000, 7, 0.95}, other{1000, 8, 0.95};
    EXPECT_EQ(difference_between(first, second, some).p, difference_between(first, second, some).p);
    EXPECT_NE(difference_between(first, second, some).interval.low,
              difference_between(first, second, other).interval.low);
}

TEST(Statistics, ConstantSamplesHaveNoPValueOrEffectSize) {
    const std::vector<double> ones(5, 1.0), twos(4, 2.0), one{1.0};
    const Difference flat = difference_between(ones, twos, many);
    EXPECT_EQ(flat.value, 1.0);
    EXPECT_EQ(flat.interval.low, 1.0);
    EXPECT_EQ(flat.interval.high, 1.0);
    EXPECT_TRUE(std::isnan(flat.p));
    EXPECT_TRUE(std::isnan(flat.effect));
    const Difference single = difference_between(one, twos, many);
    EXPECT_EQ(single.value, 1.0);
    EXPECT_TRUE(std::isnan(single.interval.low));
    EXPECT_TRUE(std::isnan(difference_within({}, many).value));
    // A mean of equal values may differ from them in the last bit.
    const Difference rounded = difference_within(std::vector<double>(7, 7.1 - 9.5), many);
    EXPECT_TRUE(std::isnan(rounded.p));
    EXPECT_TRUE(std::isnan(rounded.effect));
    // Two pairs have a deviation, and no effect size: its correction begins at two degrees of freedom.
    EXPECT_TRUE(std::isnan(difference_within(std::vector<double>{1.0, 3.0}, many).effect));
    // Only one side varies.
    EXPECT_FALSE(std::isnan(difference_between(ones, second, many).p));
}

TEST(Statistics, HugeEffectHasNoConfidenceInterval) {
    std::vector<double> far(second);
    for (double& value : far) {
        value += 1e4;
    }
    const Difference found = difference_between(first, far, many);
    EXPECT_GT(found.effect, 1000.0);
    EXPECT_TRUE(std::isnan(found.effect_interval.low));
    EXPECT_NEAR(found.p, 1.0 / (many.resamples + 1), 1e-3);
}

TEST(Statistics, HolmAdjustmentMatchesHandCalculation) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> p{0.01, nan, 0.04, 0.03, 0.005};
    const std::vector<double> adjusted = holm_adjusted(p);
    EXPECT_DOUBLE_EQ(adjusted[4], 0.02);
    EXPECT_DOUBLE_EQ(adjusted[0], 0.03);
    EXPECT_DOUBLE_EQ(adjusted[3], 0.06);
    EXPECT_DOUBLE_EQ(adjusted[2], 0.06);
    EXPECT_TRUE(std::isnan(adjusted[1]));
    EXPECT_EQ(holm_adjusted(std::vector<double>{0.6, 0.7})[1], 1.0);
}

TEST(Agreement, MatchesShroutAndFleiss) {
    // Shrout & Fleiss 1979, table 2: six targets, four judges; table 4 gives .29 and .62. Ends by
    // scipy.stats.f.
    const std::vector<std::vector<double>> scores{{9, 2, 5, 8}, {6, 1, 3, 2},  {8, 4, 6, 8},
                                                  {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
    const Agreement found = agreement(scores, 0.95);
    EXPECT_NEAR(found.single, 0.29, 0.005);
    EXPECT_NEAR(found.mean, 0.62, 0.005);
    EXPECT_NEAR(found.single, 0.2897637796, 1e-9);
    EXPECT_NEAR(found.mean, 0.6200505476, 1e-9);
    EXPECT_NEAR(found.single_interval.low, 0.0187865134, 1e-8);
    EXPECT_NEAR(found.single_interval.high, 0.7610843696, 1e-8);
    EXPECT_NEAR(found.mean_interval.low, 0.0711368153, 1e-8);
    EXPECT_NEAR(found.mean_interval.high, 0.9272320402, 1e-8);
}

TEST(Agreement, IsOneForIdenticalRatersAndNanForSingleOne) {
    const Agreement same = agreement({{1, 1}, {3, 3}, {5, 5}}, 0.95);
    EXPECT_DOUBLE_EQ(same.single, 1.0);
    EXPECT_DOUBLE_EQ(same.mean, 1.0);
    EXPECT_TRUE(std::isnan(same.single_interval.low));
    EXPECT_TRUE(std::isnan(agreement({{1, 2}}, 0.95).single));
    EXPECT_TRUE(std::isnan(agreement({{1}, {2}}, 0.95).single));
    EXPECT_TRUE(std::isnan(agreement({{2, 2}, {2, 2}}, 0.95).single));
    EXPECT_TRUE(std::isnan(agreement({}, 0.95).single));
}

}  // namespace
}  // namespace eti::review
